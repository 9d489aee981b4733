#include "offline/frame_loader.h"

#include <utility>

#include <boost/make_shared.hpp>
#include <cv_bridge/cv_bridge.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <sensor_msgs/image_encodings.h>

#include "ros/image_conversion.h"

namespace cbmv {
namespace {

namespace encodings = sensor_msgs::image_encodings;

template <typename Message>
boost::shared_ptr<Message> readMessage(const BagMessage& message, const std::string& topic) {
  try {
    return fromRawMessage<Message>(message.read());
  } catch (const ros::serialization::StreamOverrunException&) {
    throw InputError(InputFault::kTruncatedImage, topic + " has a message that is cut off");
  }
}

/// compressed_image_transport writes the encoding of the image before a semicolon.
std::string encodingOf(const cv::Mat& image, const std::string& format) {
  const bool deep = image.depth() == CV_16U;
  if (image.channels() == 1) {
    const std::string original = format.substr(0, format.find(';'));
    return encodings::isBayer(original) ? original : (deep ? encodings::MONO16 : encodings::MONO8);
  }
  if (image.channels() == 3) {
    return deep ? encodings::BGR16 : encodings::BGR8;
  }
  return deep ? encodings::BGRA16 : encodings::BGRA8;
}

cv::Mat decodeBytes(const std::vector<std::uint8_t>& bytes) {
  try {
    return bytes.empty() ? cv::Mat() : cv::imdecode(bytes, cv::IMREAD_UNCHANGED);
  } catch (const cv::Exception&) {
    return {};
  }
}

bool isPlainGrey(const std::string& encoding) {
  return encoding == encodings::TYPE_8UC1 || encoding == encodings::TYPE_16UC1;
}

/// cv_bridge takes plain channels for no image of light.
sensor_msgs::ImageConstPtr renamed(const sensor_msgs::ImageConstPtr& plain) {
  const auto image = boost::make_shared<sensor_msgs::Image>(*plain);
  image->encoding = plain->encoding == encodings::TYPE_16UC1 ? encodings::MONO16 : encodings::MONO8;
  return image;
}

/// What image_proc makes of raw images: grey or colour, with the 8 or 16 bits that they have.
sensor_msgs::ImagePtr rectify(const sensor_msgs::ImageConstPtr& raw, const std::string& topic,
                              const image_geometry::PinholeCameraModel& camera, bool color) {
  cv_bridge::CvImageConstPtr image;
  try {
    const bool deep = encodings::bitDepth(raw->encoding) == 16;
    const std::string encoding = color ? (deep ? encodings::BGR16 : encodings::BGR8)
                                       : (deep ? encodings::MONO16 : encodings::MONO8);
    image = cv_bridge::toCvShare(isPlainGrey(raw->encoding) ? renamed(raw) : raw, encoding);
  } catch (const std::exception& error) {  // cv_bridge's own, OpenCV's and unknown encodings
    throw InputError(
        InputFault::kUnsupportedEncoding,
        topic + " has the encoding '" + raw->encoding + "', which cannot be used: " + error.what());
  }
  const cv::Size size = camera.reducedResolution();
  if (image->image.size() != size) {
    throw InputError(InputFault::kCameraInfoSize, topic + " has " + sizeText(image->image.size()) +
                                                      ", its camera_info describes images of " +
                                                      sizeText(size));
  }
  cv::Mat rectified;
  camera.rectifyImage(image->image, rectified);
  return boost::make_shared<sensor_msgs::Image>(toMessage(rectified, image->encoding, raw->header));
}

using CameraModel = image_geometry::PinholeCameraModel;

std::shared_ptr<const CameraModel> makeCamera(const sensor_msgs::CameraInfo& info,
                                              const std::string& topic) {
  if (info.K[0] == 0 || info.width == 0 || info.height == 0) {
    throw InputError(InputFault::kUncalibrated,
                     topic +
                         " is raw, but its camera_info has no calibration, so it cannot be "
                         "rectified");
  }
  auto camera = std::make_shared<CameraModel>();
  camera->fromCameraInfo(info);
  // The first image, of any size, makes the maps; from then on the model is only read.
  cv::Mat ignored;
  camera->rectifyImage(cv::Mat::zeros(1, 1, CV_8UC1), ignored);
  return camera;
}

}  // namespace

sensor_msgs::ImagePtr decompressImage(const sensor_msgs::CompressedImage& message,
                                      const std::string& topic) {
  const cv::Mat image = decodeBytes(message.data);
  if (image.empty() || (image.depth() != CV_8U && image.depth() != CV_16U)) {
    throw InputError(InputFault::kUnsupportedEncoding,
                     topic + " has an image of the format '" + message.format +
                         "' that cannot be decoded; JPEG or PNG would be right");
  }
  return boost::make_shared<sensor_msgs::Image>(
      toMessage(image, encodingOf(image, message.format), message.header));
}

LoadedFrame FrameLoader::load(const PlannedFrame& frame) {
  LoadedFrame loaded;
  const auto left_info = readMessage<sensor_msgs::CameraInfo>(frame.left_info, topics_.left_info);
  const auto right_info =
      readMessage<sensor_msgs::CameraInfo>(frame.right_info, topics_.right_info);
  loaded.messages.left_image = loadImage(frame.left, topics_.left, *left_info, false);
  loaded.messages.right_image = loadImage(frame.right, topics_.right, *right_info, false);
  loaded.messages.left_info = left_info;
  loaded.messages.right_info = right_info;
  if (with_color_ && frame.color) {
    loaded.color = loadImage(*frame.color, topics_.color, *left_info, true);
  }
  return loaded;
}

StereoTopics FrameLoader::topicNames() const {
  return {topics_.left.name, topics_.left_info, topics_.right.name, topics_.right_info};
}

sensor_msgs::ImageConstPtr FrameLoader::loadImage(const BagMessage& message,
                                                  const ImageTopic& topic,
                                                  const sensor_msgs::CameraInfo& info, bool color) {
  const sensor_msgs::ImageConstPtr image =
      topic.compressed
          ? decompressImage(*readMessage<sensor_msgs::CompressedImage>(message, topic.name),
                            topic.name)
          : readMessage<sensor_msgs::Image>(message, topic.name);
  return topic.raw ? rectify(image, topic.name, *cameraOf(info, topic.name), color) : image;
}

FrameLoader::Camera FrameLoader::cameraOf(const sensor_msgs::CameraInfo& info,
                                          const std::string& topic) {
  sensor_msgs::CameraInfo calibration = info;
  calibration.header = {};
  {
    const std::lock_guard<std::mutex> lock(cameras_mutex_);
    const auto& known = cameras_[topic];
    if (known.second && known.first == calibration) {
      return known.second;
    }
  }
  // Without the mutex: OpenCV works in parallel, and a thread that waits for it may begin another
  // frame.
  Camera camera = makeCamera(info, topic);
  const std::lock_guard<std::mutex> lock(cameras_mutex_);
  cameras_[topic] = {calibration, camera};
  return camera;
}

}  // namespace cbmv
