#pragma once

#include <array>
#include <sstream>
#include <string>

#include <opencv2/core.hpp>

#include "cbmv_stereo/camera_calibration.h"

// Properties of one camera's calibration, and texts about them for messages.

namespace cbmv {

/// Concatenates the parts. Numbers have six significant digits.
template <typename... Parts>
std::string join(const Parts&... parts) {
  std::ostringstream text;
  text.precision(6);
  (text << ... << parts);
  return text.str();
}

/// Returns whether the calibration has no image size.
bool hasUnknownSize(const CameraCalibration& camera);

/// Returns whether all distortion coefficients are zero or there are none.
bool hasNoCoefficients(const CameraCalibration& camera);

/// Returns why an image of this size does not belong to the calibration, as the end of a sentence
/// that begins with the name of the calibration. Empty if it belongs, or if the calibration has no
/// size.
std::string sizeProblem(const CameraCalibration& camera, cv::Size image_size,
                        const std::string& image_name);

/// The same if R is not a rotation, without the advice what to do. Empty if R is a rotation.
std::string rotationProblem(const CameraCalibration& camera);

/// Returns whether the nine numbers are a rotation matrix: orthonormal within 1e-3, determinant 1.
bool isRotation(const std::array<double, 9>& matrix);

/// Returns whether an image needs no rectification: D is zero, R is the identity and the camera
/// matrix of P is K, each within 1e-6 (for K relative to the focal length). False for models that
/// change the image even if D is zero (equidistant).
bool isIdentity(const CameraCalibration& camera);

/// Formats a size as "640 x 480 px".
std::string sizeText(cv::Size size);

}  // namespace cbmv
