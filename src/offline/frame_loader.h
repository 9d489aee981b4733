#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <image_geometry/pinhole_camera_model.h>
#include <sensor_msgs/CompressedImage.h>

#include "offline/frame_plan.h"
#include "ros/input_messages.h"

#include "cbmv_stereo/calibration_check.h"

namespace cbmv {

/// Messages of a frame, as the node would receive them.
struct LoadedFrame {
  StereoMessages messages;
  sensor_msgs::ImageConstPtr color;  ///< may be null
  std::vector<std::string> warnings;
};

/// Rectifies the images of one camera by K, D, R and P, as image_proc does, but also if D is zero.
/// Thread-safe.
class RawCamera {
 public:
  /// `raw`: size of the images. `info_name`: name of the calibration in errors. Throws InputError
  /// with the topic if the calibration is missing, invalid, has an unknown distortion model, or
  /// belongs to another image size.
  RawCamera(const sensor_msgs::CameraInfo& info, const std::string& topic, cv::Size raw,
            std::string info_name = "its camera_info");

  /// Throws InputError with the topic if the image has another size.
  cv::Mat rectify(const cv::Mat& image, const std::string& topic) const;

 private:
  std::string info_name_;
  bool is_identity_ = false;  ///< the images are already rectified
  CameraCalibration camera_;
  image_geometry::PinholeCameraModel model_;
};

/// Decodes JPEG, PNG and all other formats that OpenCV reads to mono8, bgr8, bgra8 or their 16-bit
/// variants. A Bayer encoding in `format` is kept. Throws InputError with the topic.
sensor_msgs::ImagePtr decompressImage(const sensor_msgs::CompressedImage& message,
                                      const std::string& topic);

/// Rectifies a raw image as image_proc does: to gray or color, with its 8 or 16 bits. Throws
/// InputError with the topic.
sensor_msgs::ImagePtr rectifyImage(const sensor_msgs::ImageConstPtr& raw, const std::string& topic,
                                   const RawCamera& camera, bool color);

/// Reads, decompresses and rectifies. Thread-safe.
class FrameLoader {
 public:
  /// Without `with_color`, no color image is read.
  FrameLoader(CameraTopics topics, bool with_color)
      : topics_(std::move(topics)), with_color_(with_color) {}

  /// Throws InputError with the topic if a message cannot be used.
  LoadedFrame load(const PlannedFrame& frame);
  StereoTopics topicNames() const;
  RectifiedBy rectifiedBy() const {
    return topics_.left.raw ? RectifiedBy::kUs : RectifiedBy::kOthers;
  }

 private:
  using Camera = std::shared_ptr<const RawCamera>;
  /// The calibration of one camera, and its topic or file.
  struct CalibrationOf {
    sensor_msgs::CameraInfoConstPtr info;
    std::string name;
  };

  CalibrationOf loadInfo(const std::optional<BagMessage>& message, bool right) const;
  sensor_msgs::ImageConstPtr loadImage(const BagMessage& message, const ImageTopic& topic,
                                       const CalibrationOf& calibration, bool color,
                                       std::vector<std::string>& warnings);
  Camera cameraOf(const CalibrationOf& calibration, const std::string& topic,
                  const sensor_msgs::Image& raw);

  const CameraTopics topics_;
  const bool with_color_;
  std::mutex cameras_mutex_;
  std::map<std::string, std::pair<sensor_msgs::CameraInfo, Camera>> cameras_;  ///< keyed by topic
};

}  // namespace cbmv
