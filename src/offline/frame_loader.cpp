#include "offline/frame_loader.h"

#include <array>
#include <cstdint>
#include <string>
#include <utility>

#include <boost/make_shared.hpp>
#include <opencv2/imgproc.hpp>
#include <sensor_msgs/image_encodings.h>

#include "io/image_decoding.h"
#include "ros/camera_info.h"
#include "ros/image_conversion.h"

#include "cbmv_stereo/input/calibration_check.h"
#include "cbmv_stereo/input/gray_pair.h"

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

void requireSize(const cv::Size& size, const cv::Size& described, const std::string& topic) {
  if (size != described) {
    throw InputError(InputFault::kCameraInfoSize, topic + " has " + sizeText(size) +
                                                      ", its camera_info describes images of " +
                                                      sizeText(described));
  }
}

[[noreturn]] void failCalibration(const std::string& topic, const std::string& problem) {
  throw InputError(InputFault::kUncalibrated, topic + " is raw, but its camera_info " + problem);
}

/// image_geometry makes maps of the whole sensor, of which the image may be a small part.
void requireSensor(const sensor_msgs::CameraInfo& info, const std::string& topic) {
  if (std::uint64_t{info.width} * info.height > kMaxImagePixels) {
    throw InputError(InputFault::kCameraInfoSize,
                     topic + " is raw, and its camera_info describes a sensor of " +
                         std::to_string(info.width) + 'x' + std::to_string(info.height) +
                         " pixels, expected at most " + std::to_string(kMaxImagePixels) +
                         ". Correct width and height.");
  }
}

/// Coefficients of each model.
struct DistortionModel {
  const char* name;
  std::size_t coefficients;
};
constexpr std::array<DistortionModel, 3> kDistortionModels = {
    {{"plumb_bob", 5}, {"rational_polynomial", 8}, {"equidistant", 4}}};

const DistortionModel& findModel(const CameraCalibration& camera, const std::string& topic) {
  if (camera.distortion_model.empty() && hasNoCoefficients(camera)) {
    return kDistortionModels.front();  // simulators
  }
  for (const DistortionModel& model : kDistortionModels) {
    if (camera.distortion_model == model.name) {
      return model;
    }
  }
  failCalibration(topic, "has the unknown distortion model " + quoted(camera.distortion_model) +
                             ". Expected plumb_bob, rational_polynomial or equidistant. Name the "
                             "model of these that the coefficients D are of.");
}

/// The calibration as image_geometry takes it.
sensor_msgs::CameraInfo completed(sensor_msgs::CameraInfo info, const std::string& topic,
                                  cv::Size raw) {
  const CameraCalibration camera = toCameraCalibration(info);
  if (info.K[0] == 0) {
    failCalibration(topic, "has no calibration (K[0] = 0), so it cannot be rectified. Calibrate "
                           "the camera, or use --rectified yes for images that are rectified.");
  }
  if (!isRotation(camera.rectification)) {
    failCalibration(topic, "has R that is no rotation. Expected an orthonormal matrix, the "
                           "identity for a camera that is not turned. Calibrate the cameras, or "
                           "set R.");
  }
  const DistortionModel& model = findModel(camera, topic);
  info.distortion_model = model.name;
  if (hasNoCoefficients(camera)) {
    info.D.assign(model.coefficients, 0.0);
    info.D[0] = 1e-300;  // image_geometry does not rectify where all are zero
  }
  if (info.width == 0 && info.height == 0) {
    info.width = static_cast<std::uint32_t>(raw.width * camera.binning_x);
    info.height = static_cast<std::uint32_t>(raw.height * camera.binning_y);
  }
  return info;
}

}  // namespace

RawCamera::RawCamera(const sensor_msgs::CameraInfo& info, const std::string& topic, cv::Size raw) {
  const sensor_msgs::CameraInfo calibration = completed(info, topic, raw);
  requireSensor(calibration, topic);
  try {
    model_.fromCameraInfo(calibration);
    size_ = model_.reducedResolution();
    requireSize(raw, size_, topic);  // before maps take memory
    is_identity_ = isIdentity(toCameraCalibration(info));
    if (!is_identity_) {
      // The first image, of any size, makes the maps; from then on the model is only read.
      cv::Mat ignored;
      model_.rectifyImage(cv::Mat::zeros(1, 1, CV_8UC1), ignored);
    }
  } catch (const InputError&) {
    throw;
  } catch (const std::exception& error) {  // OpenCV's and image_geometry's own
    failCalibration(topic, std::string("cannot be used: ") + error.what());
  }
}

cv::Mat RawCamera::rectify(const cv::Mat& image, const std::string& topic) const {
  requireSize(image.size(), size_, topic);
  if (is_identity_) {
    return image;
  }
  cv::Mat rectified;
  model_.rectifyImage(image, rectified);
  return rectified;
}

sensor_msgs::ImagePtr rectifyImage(const sensor_msgs::ImageConstPtr& raw, const std::string& topic,
                                   const RawCamera& camera, bool color) {
  const cv::Mat decoded = decodeImage(*raw, raw, color, topic);
  const cv::Mat image = color ? toColor(decoded) : toGray(decoded);
  const bool deep = image.depth() == CV_16U;
  const std::string encoding = color ? (deep ? encodings::BGR16 : encodings::BGR8)
                                     : (deep ? encodings::MONO16 : encodings::MONO8);
  return boost::make_shared<sensor_msgs::Image>(
      toMessage(camera.rectify(image, topic), encoding, raw->header));
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
  std::vector<std::string>& warnings = loaded.warnings;
  const auto left_info = loadInfo(frame.left_info, false);
  const auto right_info = loadInfo(frame.right_info, true);
  loaded.messages.left_image = loadImage(frame.left, topics_.left, *left_info, false, warnings);
  loaded.messages.right_image = loadImage(frame.right, topics_.right, *right_info, false, warnings);
  loaded.messages.left_info = left_info;
  loaded.messages.right_info = right_info;
  if (with_color_ && frame.color) {
    std::vector<std::string> ignored;  // the same as of the left image
    loaded.color = loadImage(*frame.color, topics_.color, *left_info, true, ignored);
  }
  return loaded;
}

sensor_msgs::CameraInfoConstPtr FrameLoader::loadInfo(const std::optional<BagMessage>& message,
                                                      bool right) const {
  if (!message) {
    const StereoCameras& cameras = topics_.cameras.value();
    return boost::make_shared<sensor_msgs::CameraInfo>(
        toCameraInfo(right ? cameras.right : cameras.left, {}));
  }
  return readMessage<sensor_msgs::CameraInfo>(*message,
                                              right ? topics_.right_info : topics_.left_info);
}

StereoTopics FrameLoader::topicNames() const {
  return {topics_.left.name, topics_.left_info, topics_.right.name, topics_.right_info};
}

sensor_msgs::ImageConstPtr FrameLoader::loadImage(const BagMessage& message,
                                                  const ImageTopic& topic,
                                                  const sensor_msgs::CameraInfo& info, bool color,
                                                  std::vector<std::string>& warnings) {
  sensor_msgs::ImageConstPtr image =
      topic.compressed
          ? decompressImage(*readMessage<sensor_msgs::CompressedImage>(message, topic.name),
                            topic.name)
          : readMessage<sensor_msgs::Image>(message, topic.name);
  if (!topic.raw) {
    return image;
  }
  const std::string warning = encodingWarning(image->encoding, topic.name);
  if (!warning.empty()) {
    warnings.push_back(warning);
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
  const auto camera = std::make_shared<const RawCamera>(info, topic, imageSize(raw));
  const std::lock_guard<std::mutex> lock(cameras_mutex_);
  cameras_[topic] = {calibration, camera};
  return camera;
}

}  // namespace cbmv
