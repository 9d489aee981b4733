#pragma once

#include <opencv2/core.hpp>

#include "cbmv_stereo/camera_calibration.h"

namespace cbmv {

/// Pose of the right camera: x_right = rotation · x_left + translation, in m.
struct RigTransform {
  cv::Matx33d rotation = cv::Matx33d::eye();
  cv::Vec3d translation;
};

/// Computes `rectification` (R) and `projection` (P) of both cameras from their camera matrices,
/// distortion and sizes. Uses OpenCV's stereoRectify, or fisheye::stereoRectify for the model
/// equidistant, with zero disparity at infinity and alpha 0: both cameras get the same principal
/// point, and the borders have no invalid pixels.
///
/// Throws Error if
/// - the models or sizes of the cameras differ,
/// - a model is unknown, there is no size, or values are not finite,
/// - the transform is not a rotation with a translation.
void rectifyRig(StereoCameras& cameras, const RigTransform& right_from_left);

}  // namespace cbmv
