#include "offline/frame_loader.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <sstream>
#include <string>
#include <utility>

#include <boost/make_shared.hpp>
#include <opencv2/imgproc.hpp>
#include <sensor_msgs/image_encodings.h>

#include "input/camera_properties.h"
#include "io/image_decoding.h"
#include "ros/camera_info.h"
#include "ros/image_conversion.h"

#include "cbmv_stereo/calibration_check.h"
#include "cbmv_stereo/gray_pair.h"

namespace cbmv {
namespace {

namespace encodings = sensor_msgs::image_encodings;

template <typename Message>
boost::shared_ptr<Message> readMessage(const BagMessage& message, const std::string& topic) {
  try {
    return fromRawMessage<Message>(message.read());
  } catch (const ros::serialization::StreamOverrunException&) {
    throw InputError(
        InputFault::kTruncatedImage,
        topic + " has a truncated message. The bag is damaged; record or copy it again");
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

void requireSize(const CameraCalibration& camera, cv::Size size, const std::string& topic,
                 const std::string& info_name) {
  const std::string problem = sizeProblem(camera, size, topic);
  if (!problem.empty()) {
    throw InputError(InputFault::kCameraInfoSize, info_name + " " + problem);
  }
}

/// `names`: the images and the calibration, formatted for the message.
[[noreturn]] void failCalibration(const std::string& names, const std::string& problem) {
  throw InputError(InputFault::kUncalibrated, names + " " + problem);
}

/// image_geometry allocates maps for the whole sensor, even if the image is a small part of it.
void requireSensor(const sensor_msgs::CameraInfo& info, const std::string& names) {
  if (std::uint64_t{info.width} * info.height > kMaxImagePixels) {
    throw InputError(InputFault::kCameraInfoSize,
                     names + " describes a sensor of " + std::to_string(info.width) + 'x' +
                         std::to_string(info.height) + " pixels, expected at most " +
                         std::to_string(kMaxImagePixels) + ". Correct width and height.");
  }
}

struct DistortionModel {
  const char* name;
  std::size_t coefficients;             ///< of the model
  std::array<std::size_t, 5> accepted;  ///< numbers of coefficients that OpenCV accepts
  const char* counts;                   ///< `accepted` as text
};
constexpr std::array<DistortionModel, 3> kDistortionModels = {
    {{"plumb_bob", 5, {4, 5, 8, 12, 14}, "4, 5, 8, 12 or 14"},
     {"rational_polynomial", 8, {4, 5, 8, 12, 14}, "4, 5, 8, 12 or 14"},
     {"equidistant", 4, {4}, "4"}}};

const DistortionModel& findModel(const CameraCalibration& camera, const std::string& names) {
  if (camera.distortion_model.empty() && hasNoCoefficients(camera)) {
    return kDistortionModels.front();  // set by simulators
  }
  for (const DistortionModel& model : kDistortionModels) {
    if (camera.distortion_model == model.name) {
      return model;
    }
  }
  failCalibration(names, "has an unknown distortion model " + quoted(camera.distortion_model) +
                             ". Expected plumb_bob, rational_polynomial or equidistant. Set "
                             "distortion_model to the model of the coefficients D.");
}

void requireCoefficients(const CameraCalibration& camera, const DistortionModel& model,
                         const std::string& names) {
  const std::size_t count = camera.distortion.size();
  const auto& accepted = model.accepted;
  if (std::find(accepted.begin(), accepted.end(), count) == accepted.end()) {
    failCalibration(names, "has " + std::to_string(count) +
                               " distortion coefficients D of the model " + model.name +
                               ", expected " + model.counts + ". Correct D or distortion_model.");
  }
}

/// Values that are not finite would yield an image without valid pixels.
void requireUsableNumbers(const CameraCalibration& camera, const std::string& names) {
  const auto require = [&](bool usable, const char* entry, std::size_t index, double value) {
    if (!usable) {
      std::ostringstream text;
      text << "has no usable calibration (" << entry << "[" << index << "] = " << value
           << "). Expected finite numbers, K[0] and K[4] above 0. Calibrate the camera, or use "
              "--rectified yes if the images are rectified.";
      failCalibration(names, text.str());
    }
  };
  const auto& k = camera.camera_matrix;
  for (std::size_t i = 0; i < k.size(); ++i) {
    require(std::isfinite(k[i]) && ((i != 0 && i != 4) || k[i] > 0), "K", i, k[i]);
  }
  for (std::size_t i = 0; i < camera.distortion.size(); ++i) {
    require(std::isfinite(camera.distortion[i]), "D", i, camera.distortion[i]);
  }
}

/// If the sensor size is unknown, uses the size that the image covers.
std::uint32_t sensorSide(std::uint32_t offset, std::uint32_t roi, int raw, int binning) {
  const std::uint64_t side =
      roi > 0 ? std::uint64_t{offset} + roi
              : static_cast<std::uint64_t>(raw) * static_cast<std::uint64_t>(binning);
  return static_cast<std::uint32_t>(
      std::min<std::uint64_t>(side, std::numeric_limits<std::uint32_t>::max()));
}

/// Completes the calibration for image_geometry.
sensor_msgs::CameraInfo completed(sensor_msgs::CameraInfo info, const std::string& names,
                                  cv::Size raw) {
  const CameraCalibration camera = toCameraCalibration(info);
  requireUsableNumbers(camera, names);
  const std::string rotation = rotationProblem(camera);
  if (!rotation.empty()) {
    failCalibration(names, rotation + " Calibrate the cameras, or set R.");
  }
  const DistortionModel& model = findModel(camera, names);
  info.distortion_model = model.name;
  if (hasNoCoefficients(camera)) {
    info.D.assign(model.coefficients, 0.0);
    info.D[0] = 1e-300;  // image_geometry skips rectification if all are zero
  } else {
    requireCoefficients(camera, model, names);
  }
  if (info.width == 0 && info.height == 0) {
    info.width = sensorSide(info.roi.x_offset, info.roi.width, raw.width, camera.binning_x);
    info.height = sensorSide(info.roi.y_offset, info.roi.height, raw.height, camera.binning_y);
  }
  return info;
}

}  // namespace

RawCamera::RawCamera(const sensor_msgs::CameraInfo& info, const std::string& topic, cv::Size raw,
                     std::string info_name)
    : info_name_(std::move(info_name)) {
  const std::string names = topic + " is raw, but " + info_name_;
  const sensor_msgs::CameraInfo calibration = completed(info, names, raw);
  requireSensor(calibration, names);
  try {
    camera_ = toCameraCalibration(calibration);
    requireSize(camera_, raw, topic, info_name_);  // before maps are allocated
    model_.fromCameraInfo(calibration);
    is_identity_ = isIdentity(toCameraCalibration(info));
    if (!is_identity_) {
      // The first call, with any image, creates the maps. After that the model is only read.
      cv::Mat ignored;
      model_.rectifyImage(cv::Mat::zeros(1, 1, CV_8UC1), ignored);
    }
  } catch (const InputError&) {
    throw;
  } catch (const std::exception& error) {  // thrown by OpenCV or image_geometry
    if (calibration.distortion_model == "equidistant") {
      failCalibration(names,
                      std::string("has the distortion model equidistant, which the installed "
                                  "image_geometry cannot rectify (") +
                          error.what() +
                          "). Expected image_geometry 1.16 or newer. Rectify the images "
                          "first, and use --rectified yes.");
    }
    failCalibration(names,
                    std::string("cannot be used: ") + error.what() + ". Correct the calibration.");
  }
}

cv::Mat RawCamera::rectify(const cv::Mat& image, const std::string& topic) const {
  requireSize(camera_, image.size(), topic, info_name_);
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
                     topic + " has an image with format '" + message.format +
                         "' that cannot be decoded, expected JPEG or PNG of at most " +
                         std::to_string(kMaxImagePixels) + " pixels. Record it again");
  }
  return boost::make_shared<sensor_msgs::Image>(
      toMessage(image, encodingOf(image, message.format), message.header));
}

LoadedFrame FrameLoader::load(const PlannedFrame& frame) {
  LoadedFrame loaded;
  std::vector<std::string>& warnings = loaded.warnings;
  const CalibrationOf left = loadInfo(frame.left_info, false);
  const CalibrationOf right = loadInfo(frame.right_info, true);
  loaded.messages.left_image = loadImage(frame.left, topics_.left, left, false, warnings);
  loaded.messages.right_image = loadImage(frame.right, topics_.right, right, false, warnings);
  loaded.messages.left_info = left.info;
  loaded.messages.right_info = right.info;
  if (with_color_ && frame.color) {
    std::vector<std::string> ignored;  // same as for the left image
    loaded.color = loadImage(*frame.color, topics_.color, left, true, ignored);
  }
  return loaded;
}

FrameLoader::CalibrationOf FrameLoader::loadInfo(const std::optional<BagMessage>& message,
                                                 bool right) const {
  const std::string& name = right ? topics_.right_info : topics_.left_info;
  if (message) {
    return {readMessage<sensor_msgs::CameraInfo>(*message, name), name};
  }
  const StereoCameras& cameras = topics_.cameras.value();
  return {boost::make_shared<sensor_msgs::CameraInfo>(
              toCameraInfo(right ? cameras.right : cameras.left, {})),
          name};
}

StereoTopics FrameLoader::topicNames() const {
  return {topics_.left.name, topics_.left_info, topics_.right.name, topics_.right_info};
}

sensor_msgs::ImageConstPtr FrameLoader::loadImage(const BagMessage& message,
                                                  const ImageTopic& topic,
                                                  const CalibrationOf& calibration, bool color,
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
  return rectifyImage(image, topic.name, *cameraOf(calibration, topic.name, *image), color);
}

FrameLoader::Camera FrameLoader::cameraOf(const CalibrationOf& calibration,
                                          const std::string& topic, const sensor_msgs::Image& raw) {
  sensor_msgs::CameraInfo info = *calibration.info;
  info.header = {};
  {
    const std::lock_guard<std::mutex> lock(cameras_mutex_);
    const auto& known = cameras_[topic];
    if (known.second && known.first == info) {
      return known.second;
    }
  }
  // Without the mutex, because OpenCV runs in parallel: a waiting thread may start another frame
  // and lock the mutex again.
  const auto camera =
      std::make_shared<const RawCamera>(info, topic, imageSize(raw), calibration.name);
  const std::lock_guard<std::mutex> lock(cameras_mutex_);
  cameras_[topic] = {info, camera};
  return camera;
}

}  // namespace cbmv
