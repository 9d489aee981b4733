#pragma once

#include <string>

#include "offline/bag_set.h"

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
};

/// What the user says of the topics; empty: find it.
struct TopicChoice {
  std::string left;              ///< topic of the left images
  std::string right;             ///< topic of the right images
  std::string camera_namespace;  ///< of left/… and right/…, and of the outputs
};

/// Finds the topics of the stereo camera: NAMESPACE/left/… and NAMESPACE/right/… of which the first
/// that both have is taken: image_rect, image_rect_color, image_raw, each as it is or /compressed;
/// with camera_info beside them. Images whose name holds no "rect" are raw. Throws Error that lists
/// what is in the bags if there is no such camera, or more than one.
CameraTopics findCameraTopics(const BagSet& bags, const TopicChoice& choice);

}  // namespace cbmv
