#pragma once

#include <optional>
#include <string>

#include "offline/bag_set.h"

#include "cbmv_stereo/camera_calibration.h"

namespace cbmv {

/// A topic of images.
struct ImageTopic {
  std::string name;
  bool compressed = false;  ///< sensor_msgs/CompressedImage
  bool raw = false;         ///< still to be rectified
};

/// The topics of a stereo camera.
struct CameraTopics {
  ImageTopic left;
  ImageTopic right;
  std::string left_info;
  std::string right_info;
  ImageTopic color;              ///< of the left camera, for the cloud; without a name: none
  std::string output_namespace;  ///< ends without a slash
  /// Calibrations that were given instead of camera_info; the names of these are files then.
  std::optional<StereoCameras> cameras;
  std::string rectification;  ///< one sentence: who rectifies the images, and why that was chosen
};

/// Whether the images in the bags are rectified.
enum class Rectified {
  kAuto,  ///< those whose topic's name holds "rect"
  kYes,
  kNo,
};

/// What the user says of the topics; empty: find it.
struct TopicChoice {
  std::string left;              ///< topic of the left images
  std::string right;             ///< topic of the right images
  std::string camera_namespace;  ///< of left/… and right/…, and of the outputs
  Rectified rectified = Rectified::kAuto;
  std::string left_calibration;   ///< file for readStereoCameras, instead of camera_info
  std::string right_calibration;  ///< empty where one file describes both
};

/// Finds the topics of the stereo camera: NAMESPACE/left/… and NAMESPACE/right/… of which the first
/// that both have is taken: image_rect, image_rect_color, image_raw, each as it is or /compressed;
/// with camera_info beside them, unless calibrations are given. Names without a slash at the
/// beginning get one. Throws Error that lists what is in the bags if there is no such camera, or
/// more than one; if left and right are one topic; if a calibration cannot be read, or does not
/// tell how to rectify images that are raw.
CameraTopics findCameraTopics(const BagSet& bags, const TopicChoice& choice);

}  // namespace cbmv
