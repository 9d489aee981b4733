#pragma once

#include <array>

#include "ros/sync_monitor.h"
#include "ros/synchronized_inputs.h"

// Input topics of the nodelets, relative to their namespace; same as stereo_image_proc.

namespace cbmv {

/// Indexed by InputIndex.
using InputTopics = std::array<const char*, kInputs>;

using StereoInputs = SynchronizedInputs<sensor_msgs::Image, sensor_msgs::Image>;
inline constexpr InputTopics kStereoInputTopics = {"left/image_rect", "left/camera_info",
                                                   "right/image_rect", "right/camera_info"};
inline constexpr const char* kColorTopic = "left/image_rect_color";
/// Private parameters with the topic names.
inline constexpr InputTopics kStereoTopicParameters = {"left_image_topic", "left_info_topic",
                                                       "right_image_topic", "right_info_topic"};
inline constexpr const char* kColorTopicParameter = "left_color_topic";

using CloudInputs = SynchronizedInputs<sensor_msgs::Image, stereo_msgs::DisparityImage>;
inline constexpr InputTopics kCloudInputTopics = {kColorTopic, "left/camera_info", "disparity",
                                                  "right/camera_info"};

}  // namespace cbmv
