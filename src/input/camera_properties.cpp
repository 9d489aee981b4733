#include "input/camera_properties.h"

#include <algorithm>
#include <cmath>

namespace cbmv {
namespace {

constexpr double kZeroRatio = 1e-6;  // relative to the focal length, and absolute for entries of R
constexpr double kRotationError = 1e-3;

bool hasRoi(const CameraCalibration& camera) {
  return camera.roi.width > 0 && camera.roi.height > 0;
}

/// The size of the images that the calibration describes.
cv::Size describedSize(const CameraCalibration& camera) {
  const cv::Size whole = hasRoi(camera) ? camera.roi.size() : cv::Size(camera.width, camera.height);
  return {whole.width / camera.binning_x, whole.height / camera.binning_y};
}

}  // namespace

bool hasUnknownSize(const CameraCalibration& camera) {
  return !hasRoi(camera) && camera.width <= 0 && camera.height <= 0;
}

std::string sizeProblem(const CameraCalibration& camera, cv::Size image_size,
                        const std::string& image_name) {
  const cv::Size size = describedSize(camera);
  if (hasUnknownSize(camera) || size == image_size) {
    return {};
  }
  const std::string image = image_name + " has " + sizeText(image_size);
  if (size == cv::Size(image_size.height, image_size.width)) {
    return "describes images of " + sizeText(size) + ", " + image +
           ": width and height are exchanged. Exchange them in the calibration.";
  }
  if (hasRoi(camera)) {
    return "describes images of " + sizeText(size) + " by its region of interest (roi) of " +
           sizeText(camera.roi.size()) + ", " + image +
           ". Set the roi to the part of the sensor that the image shows, or to 0 for all.";
  }
  const bool binned = camera.binning_x > 1 || camera.binning_y > 1;
  return "describes images of " + sizeText(size) +
         (binned ? join(" (binning ", camera.binning_x, " x ", camera.binning_y, ")") : "") + ", " +
         image + ". Calibrate at this resolution, or set binning where the image is a reduced one.";
}

std::string rotationProblem(const CameraCalibration& camera) {
  const auto& r = camera.rectification;
  if (isRotation(r)) {
    return {};
  }
  const bool is_zero = std::all_of(r.begin(), r.end(), [](double value) { return value == 0; });
  const std::string rows = join(r[0], ", ", r[1], ", ", r[2], "; ", r[3], ", ", r[4], ", ", r[5],
                                "; ", r[6], ", ", r[7], ", ", r[8]);
  return "has R that is no rotation (" + (is_zero ? "all zero" : rows) +
         "). Expected an orthonormal matrix, the identity for a camera that is not turned.";
}

bool hasNoCoefficients(const CameraCalibration& camera) {
  return std::all_of(camera.distortion.begin(), camera.distortion.end(),
                     [](double coefficient) { return coefficient == 0; });
}

bool isRotation(const std::array<double, 9>& matrix) {
  const cv::Matx33d r(matrix.data());
  const cv::Matx33d error = r * r.t() - cv::Matx33d::eye();
  // False for NaN.
  return cv::norm(error, cv::NORM_INF) <= kRotationError && cv::determinant(r) > 0;
}

bool isIdentity(const CameraCalibration& camera) {
  const auto& k = camera.camera_matrix;
  const auto& p = camera.projection;
  const cv::Matx33d turn = cv::Matx33d(camera.rectification.data()) - cv::Matx33d::eye();
  const cv::Matx33d change =
      cv::Matx33d(k.data()) - cv::Matx33d(p[0], p[1], p[2], p[4], p[5], p[6], p[8], p[9], p[10]);
  return hasNoCoefficients(camera) && camera.distortion_model != "equidistant" &&
         cv::norm(turn, cv::NORM_INF) <= kZeroRatio &&
         cv::norm(change, cv::NORM_INF) <= kZeroRatio * std::abs(k[0]);
}

std::string sizeText(cv::Size size) {
  return std::to_string(size.width) + " x " + std::to_string(size.height) + " px";
}

}  // namespace cbmv
