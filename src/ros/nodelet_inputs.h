#pragma once

#include <array>

#include "ros/synchronized_inputs.h"

// The topics that the nodelets read, relative to their namespace: those of stereo_image_proc.

namespace cbmv {

using StereoInputs = SynchronizedInputs<sensor_msgs::Image, sensor_msgs::CameraInfo,
                                        sensor_msgs::Image, sensor_msgs::CameraInfo>;
inline constexpr StereoInputs::Topics kStereoInputTopics = {
    "left/image_rect", "left/camera_info", "right/image_rect", "right/camera_info"};

using CloudInputs = SynchronizedInputs<sensor_msgs::Image, sensor_msgs::CameraInfo,
                                       sensor_msgs::CameraInfo, stereo_msgs::DisparityImage>;
inline constexpr const char* kColorTopic = "left/image_rect_color";
inline constexpr CloudInputs::Topics kCloudInputTopics = {kColorTopic, "left/camera_info",
                                                          "right/camera_info", "disparity"};

}  // namespace cbmv
