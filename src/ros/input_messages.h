#pragma once

#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/Image.h>

#include "cbmv_stereo/error.h"

namespace cbmv {

/// One synchronized set of input messages.
struct StereoMessages {
  sensor_msgs::ImageConstPtr left_image;
  sensor_msgs::CameraInfoConstPtr left_info;
  sensor_msgs::ImageConstPtr right_image;
  sensor_msgs::CameraInfoConstPtr right_info;
};

/// Resolved topic names of the inputs, for messages.
using StereoTopics = InputNames;

}  // namespace cbmv
