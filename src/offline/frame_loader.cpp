#include "offline/frame_loader.h"

#include <cstdint>
#include <string>
#include <utility>

#include <boost/make_shared.hpp>
#include <cv_bridge/cv_bridge.h>
#include <opencv2/imgproc.hpp>
#include <sensor_msgs/image_encodings.h>

#include "io/image_decoding.h"
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

bool isPlainGrey(const std::string& encoding) {
  return encoding == encodings::TYPE_8UC1 || encoding == encodings::TYPE_16UC1;
}

/// cv_bridge takes plain channels for no image of light.
sensor_msgs::ImageConstPtr renamed(const sensor_msgs::ImageConstPtr& plain) {
  const auto image = boost::make_shared<sensor_msgs::Image>(*plain);
  image->encoding = plain->encoding == encodings::TYPE_16UC1 ? encodings::MONO16 : encodings::MONO8;
  return image;
}

void requireSize(const cv::Size& size, const cv::Size& described, const std::string& topic) {
  if (size != described) {
    throw InputError(InputFault::kCameraInfoSize, topic + " has " + sizeText(size) +
                                                      ", its camera_info describes images of " +
                                                      sizeText(described));
  }
}

/// image_geometry makes maps of the whole sensor, of which the image may be a small part.
void requireSensor(const sensor_msgs::CameraInfo& info, const std::string& topic) {
  if (std::uint64_t{info.width} * info.height > kMaxImagePixels) {
    throw InputError(InputFault::kCameraInfoSize,
                     topic + " is raw, and its camera_info describes a sensor of " +
                         std::to_string(info.width) + 'x' + std::to_string(info.height) + "; " +
                         std::to_string(kMaxImagePixels) + " pixels at most would be right");
  }
}

using CameraModel = image_geometry::PinholeCameraModel;

/// With the maps of the rectification: from then on the model is only read.
std::shared_ptr<const CameraModel> withMaps(const std::shared_ptr<CameraModel>& camera) {
  cv::Mat ignored;  // the first image, of any size, makes the maps
  camera->rectifyImage(cv::Mat::zeros(1, 1, CV_8UC1), ignored);
  return camera;
}

}  // namespace

std::shared_ptr<const CameraModel> makeCamera(const sensor_msgs::CameraInfo& info,
                                              const std::string& topic,
                                              const sensor_msgs::Image& raw) {
  if (info.K[0] == 0 || info.width == 0 || info.height == 0) {
    throw InputError(InputFault::kUncalibrated,
                     topic +
                         " is raw, but its camera_info has no calibration, so it cannot be "
                         "rectified");
  }
  requireSensor(info, topic);
  auto camera = std::make_shared<CameraModel>();
  try {
    camera->fromCameraInfo(info);
    requireSize(imageSize(raw), camera->reducedResolution(), topic);  // before maps take memory
    return withMaps(camera);
  } catch (const InputError&) {
    throw;
  } catch (const std::exception& error) {  // OpenCV's and image_geometry's own
    throw InputError(InputFault::kUncalibrated,
                     topic + " is raw, but its camera_info cannot be used: " + error.what());
  }
}

sensor_msgs::ImagePtr rectifyImage(const sensor_msgs::ImageConstPtr& raw, const std::string& topic,
                                   const CameraModel& camera, bool color) {
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
  requireSize(image->image.size(), camera.reducedResolution(), topic);
  cv::Mat rectified;
  camera.rectifyImage(image->image, rectified);
  return boost::make_shared<sensor_msgs::Image>(toMessage(rectified, image->encoding, raw->header));
}

sensor_msgs::ImagePtr decompressImage(const sensor_msgs::CompressedImage& message,
                                      const std::string& topic) {
  const std::uint64_t pixels = claimedPixels(message.data.data(), message.data.size());
  const cv::Mat image =
      pixels > kMaxImagePixels ? cv::Mat() : decodeImage(message.data, cv::IMREAD_UNCHANGED);
  if (image.empty() || (image.depth() != CV_8U && image.depth() != CV_16U)) {
    throw InputError(InputFault::kUnsupportedEncoding,
                     topic + " has an image of the format '" + message.format +
                         "' that cannot be decoded; JPEG or PNG of at most " +
                         std::to_string(kMaxImagePixels) + " pixels would be right");
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
  sensor_msgs::ImageConstPtr image =
      topic.compressed
          ? decompressImage(*readMessage<sensor_msgs::CompressedImage>(message, topic.name),
                            topic.name)
          : readMessage<sensor_msgs::Image>(message, topic.name);
  if (!topic.raw) {
    return image;
  }
  return rectifyImage(image, topic.name, *cameraOf(info, topic.name, *image), color);
}

FrameLoader::Camera FrameLoader::cameraOf(const sensor_msgs::CameraInfo& info,
                                          const std::string& topic, const sensor_msgs::Image& raw) {
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
  Camera camera = makeCamera(info, topic, raw);
  const std::lock_guard<std::mutex> lock(cameras_mutex_);
  cameras_[topic] = {calibration, camera};
  return camera;
}

}  // namespace cbmv
