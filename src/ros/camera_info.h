#pragma once

#include <opencv2/core.hpp>
#include <sensor_msgs/CameraInfo.h>

#include "cbmv_stereo/calibration_check.h"
#include "cbmv_stereo/camera_calibration.h"

// Calibrations of messages as the core's types and back.

namespace cbmv {

/// Without the header. A binning of 0, which stands for none, becomes 1; sizes beyond the range of
/// int are its largest.
CameraCalibration toCameraCalibration(const sensor_msgs::CameraInfo& info);

sensor_msgs::CameraInfo toCameraInfo(const CameraCalibration& camera,
                                     const std_msgs::Header& header);

/// The geometry of a rectified pair from the infos of both cameras; `topics` names the infos to
/// people. Throws InputError with the first error of checkCalibration.
StereoGeometry toGeometry(const sensor_msgs::CameraInfo& left_info,
                          const sensor_msgs::CameraInfo& right_info, cv::Size image_size,
                          const InputNames& topics);

/// Of images in the left camera's rectified frame, `size` large: K is the projection matrix's, no
/// distortion, rotation, binning nor region of interest are left.
sensor_msgs::CameraInfo toRectifiedInfo(const StereoGeometry& geometry, cv::Size size,
                                        const std_msgs::Header& header);

}  // namespace cbmv
