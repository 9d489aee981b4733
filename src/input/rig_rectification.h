#pragma once

#include <opencv2/core.hpp>

#include "cbmv_stereo/camera_calibration.h"

namespace cbmv {

/// Where the right camera stands: x_right = rotation · x_left + translation, m.
struct RigTransform {
  cv::Matx33d rotation = cv::Matx33d::eye();
  cv::Vec3d translation;
};

/// Sets `rectification` (R) and `projection` (P) of both cameras from their camera matrices, models
/// and coefficients of distortion and sizes: by rotations, with the same principal point and
/// without invalid pixels at the borders (OpenCV's stereoRectify, or fisheye::stereoRectify for the
/// model equidistant; zero disparity at infinity, alpha 0). Throws Error when the cameras have
/// other models or sizes than each other, a model that is not known, no size, values that are not
/// finite, or a transform that is no rotation with a translation.
void rectifyRig(StereoCameras& cameras, const RigTransform& right_from_left);

}  // namespace cbmv
