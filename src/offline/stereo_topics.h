#pragma once

#include <optional>
#include <string>

#include "offline/bag_set.h"

#include "cbmv_stereo/camera_calibration.h"

namespace cbmv {

/// An image topic.
struct ImageTopic {
  std::string name;
  bool compressed = false;  ///< sensor_msgs/CompressedImage
  bool raw = false;         ///< needs rectification
};

/// The topics of a stereo camera.
struct CameraTopics {
  ImageTopic left;
  ImageTopic right;
  std::string left_info;
  std::string right_info;
  ImageTopic color;              ///< left camera, for the point cloud; empty name: none
  std::string output_namespace;  ///< without trailing slash
  /// Calibration from files instead of camera_info; left_info and right_info are then file names.
  std::optional<StereoCameras> cameras;
  std::string rectification;  ///< message: who rectifies the images, and why
};

/// Whether the images in the bags are rectified.
enum class Rectified {
  kAuto,  ///< if the topic name contains "rect"
  kYes,
  kNo,
};

/// Topics given by the user; empty: find them.
struct TopicChoice {
  std::string left;              ///< topic of the left images
  std::string right;             ///< topic of the right images
  std::string camera_namespace;  ///< namespace of left/… and right/…, and of the outputs
  Rectified rectified = Rectified::kAuto;
  std::string left_calibration;   ///< file for readStereoCameras, used instead of camera_info
  std::string right_calibration;  ///< empty if one file describes both cameras
};

/// Finds the topics of the stereo camera NAMESPACE/left/… and NAMESPACE/right/…. Takes the first
/// image topic that both cameras have: image_rect, image_rect_color, image_raw, each plain or with
/// /compressed. camera_info must be beside them unless a calibration is given. Relative names get a
/// leading slash. Throws Error with the content of the bags if there is no stereo camera or more
/// than one; if left and right are the same topic; if a calibration cannot be read or is
/// insufficient to rectify raw images.
CameraTopics findCameraTopics(const BagSet& bags, const TopicChoice& choice);

}  // namespace cbmv
