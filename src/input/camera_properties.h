#pragma once

#include <array>
#include <sstream>
#include <string>

#include <opencv2/core.hpp>

#include "cbmv_stereo/camera_calibration.h"

// What one camera's calibration tells by itself, and how messages say it.

namespace cbmv {

/// The parts one after another, numbers with six digits.
template <typename... Parts>
std::string join(const Parts&... parts) {
  std::ostringstream text;
  text.precision(6);
  (text << ... << parts);
  return text.str();
}

/// Whether the calibration tells no size of images.
bool hasUnknownSize(const CameraCalibration& camera);

/// Whether all coefficients of the distortion are zero, or there is none.
bool hasNoCoefficients(const CameraCalibration& camera);

/// Why an image of this size does not belong to the calibration, as the end of a sentence that
/// begins with the calibration's name; empty if it does, or the calibration tells no size.
std::string sizeProblem(const CameraCalibration& camera, cv::Size image_size,
                        const std::string& image_name);

/// The same of R that is no rotation, without what to do; empty if it is one.
std::string rotationProblem(const CameraCalibration& camera);

/// Whether the nine numbers are a rotation matrix: orthonormal within 1e-3, determinant 1.
bool isRotation(const std::array<double, 9>& matrix);

/// Whether an image needs no rectification: D is zero (of a model that leaves the image as it is
/// then: not of equidistant), R the identity and P's camera matrix K, each within 1e-6 (of the
/// focal length for K).
bool isIdentity(const CameraCalibration& camera);

/// "640 x 480 px".
std::string sizeText(cv::Size size);

}  // namespace cbmv
