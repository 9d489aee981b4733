#pragma once

#include <opencv2/core.hpp>
#include <sensor_msgs/CameraInfo.h>

#include "cbmv_stereo/calibration_check.h"
#include "cbmv_stereo/camera_calibration.h"

// Converts camera_info messages to calibration types of the core and back.

namespace cbmv {

/// Ignores the header. A binning of 0 means none and becomes 1. Sizes outside the range of int
/// become its maximum.
CameraCalibration toCameraCalibration(const sensor_msgs::CameraInfo& info);

sensor_msgs::CameraInfo toCameraInfo(const CameraCalibration& camera,
                                     const std_msgs::Header& header);

/// Geometry of a rectified pair from the camera_infos of both cameras. `topics`: their names for
/// messages. Throws InputError with the first error of checkCalibration.
StereoGeometry toGeometry(const sensor_msgs::CameraInfo& left_info,
                          const sensor_msgs::CameraInfo& right_info, cv::Size image_size,
                          const InputNames& topics);

/// camera_info for images of `size` in the left camera's rectified frame: K is that of the
/// projection matrix; no distortion, rotation, binning or region of interest.
sensor_msgs::CameraInfo toRectifiedInfo(const StereoGeometry& geometry, cv::Size size,
                                        const std_msgs::Header& header);

}  // namespace cbmv
