#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <string>

#include <image_geometry/pinhole_camera_model.h>
#include <sensor_msgs/CompressedImage.h>

#include "offline/frame_plan.h"
#include "ros/input_messages.h"

#include "cbmv_stereo/input/calibration_check.h"

namespace cbmv {

/// Messages of a frame as the live node would get them.
struct LoadedFrame {
  StereoMessages messages;
  sensor_msgs::ImageConstPtr color;  ///< may be null
};

/// JPEG, PNG and whatever OpenCV reads, as mono8, bgr8, bgra8 or 16 bits of these; what `format`
/// calls a Bayer image keeps that encoding. Throws InputError that names the topic.
sensor_msgs::ImagePtr decompressImage(const sensor_msgs::CompressedImage& message,
                                      const std::string& topic);

/// The calibration of a raw image. Throws InputError that names the topic if it has none, a useless
/// one, or that of images of another size.
std::shared_ptr<const image_geometry::PinholeCameraModel> makeCamera(
    const sensor_msgs::CameraInfo& info, const std::string& topic, const sensor_msgs::Image& raw);

/// What image_proc makes of a raw image: grey or colour, with the 8 or 16 bits that it has. Throws
/// InputError that names the topic.
sensor_msgs::ImagePtr rectifyImage(const sensor_msgs::ImageConstPtr& raw, const std::string& topic,
                                   const image_geometry::PinholeCameraModel& camera, bool color);

/// Reads, unpacks and rectifies. May be used by several threads at once.
class FrameLoader {
 public:
  /// Without `with_color` no colour image is read.
  FrameLoader(CameraTopics topics, bool with_color)
      : topics_(std::move(topics)), with_color_(with_color) {}

  /// Throws InputError that names the topic if a message cannot be used.
  LoadedFrame load(const PlannedFrame& frame);
  StereoTopics topicNames() const;
  RectifiedBy rectifiedBy() const {
    return topics_.left.raw ? RectifiedBy::kUs : RectifiedBy::kOthers;
  }

 private:
  using Camera = std::shared_ptr<const image_geometry::PinholeCameraModel>;

  sensor_msgs::ImageConstPtr loadImage(const BagMessage& message, const ImageTopic& topic,
                                       const sensor_msgs::CameraInfo& info, bool color);
  Camera cameraOf(const sensor_msgs::CameraInfo& info, const std::string& topic,
                  const sensor_msgs::Image& raw);

  const CameraTopics topics_;
  const bool with_color_;
  std::mutex cameras_mutex_;
  std::map<std::string, std::pair<sensor_msgs::CameraInfo, Camera>> cameras_;  ///< by topic
};

}  // namespace cbmv
