#pragma once

#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/Image.h>

#include "cbmv_stereo/error.h"

namespace cbmv {

/// One synchronised set of input messages, each with the topic it came on.
struct StereoMessages {
  sensor_msgs::ImageConstPtr left_image;
  sensor_msgs::CameraInfoConstPtr left_info;
  sensor_msgs::ImageConstPtr right_image;
  sensor_msgs::CameraInfoConstPtr right_info;
};

/// Resolved topic names of the inputs, for messages to people.
using StereoTopics = InputNames;

}  // namespace cbmv
