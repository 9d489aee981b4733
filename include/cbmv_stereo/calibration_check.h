#pragma once

#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "cbmv_stereo/camera_calibration.h"
#include "cbmv_stereo/error.h"
#include "cbmv_stereo/export.h"

namespace cbmv {

/// The geometry of a rectified stereo camera. All values in px are for the images as published,
/// after binning and region of interest.
struct StereoGeometry {
  double focal_length_px = 0;  ///< right camera, horizontal: f in Z = f T / d
  /// The baseline T is left P[3] / fx − right P[3] / fx. T > 0: the right camera is to the right of
  /// the left camera. 0: not calibrated. The left camera may have P[3] ≠ 0, for example in rigs of
  /// several cameras.
  double baseline_m = 0;
  /// cx_left − cx_right. It is 0 unless the cameras are verged. A point at infinity is matched at
  /// this disparity, so it is subtracted once from every published disparity.
  double disparity_offset_px = 0;
  double left_fx_px = 0;
  double left_fy_px = 0;
  double left_cx_px = 0;
  double left_cy_px = 0;
};

/// Who rectifies the images.
enum class RectifiedBy {
  kOthers,  ///< a driver or image_proc, which may have skipped images without distortion
  kFiles,   ///< the author of the image files: the images are rectified
  kUs,      ///< this package: the images are raw, it rectifies them by K, D, R and P
};

/// The reason why a calibration cannot be used.
struct CalibrationError {
  InputFault fault;
  std::string text;
};

/// The result of checkCalibration. Each text names the camera, the entry and its value, what was
/// expected, and what to do.
struct CalibrationCheck {
  std::vector<CalibrationError> errors;  ///< if not empty, the calibration gives no depth
  std::vector<std::string> warnings;     ///< depth is computed, but is probably wrong
  StereoGeometry geometry;               ///< valid only without errors
};

/// Checks the calibrations of both cameras against each other and against the image size. The texts
/// use `names`.
///
/// Errors:
/// - P has entries that are not finite, or focal lengths that are not positive;
/// - the images do not have the described size (width and height are exchanged, or a region of
///   interest or binning does not fit);
/// - the baseline is zero, or negative (the cameras are exchanged);
/// - R is not a rotation, for images that this package rectifies by R.
///
/// Warnings:
/// - fx, fy or cy of P differ between left and right, or fx differs from fy;
/// - entries of P are not 0 although they are 0 in a rectified pair: P[1], P[4], P[8], P[9],
///   P[7] (the cameras differ in height), P[11] (they differ in depth);
/// - P[10] is not 1;
/// - the baseline is outside of 5 mm to 5 m;
/// - the principal point is outside of the image;
/// - width and height are 0, so that the size of the image is used (not with RectifiedBy::kFiles,
///   because calibration files often have no size);
/// - R is not a rotation, for images that are already rectified;
/// - D = 0, although R is not the identity or P differs from K (only with RectifiedBy::kOthers):
///   image_proc does not rectify images without distortion, so they are perhaps not rectified.
CBMV_API CalibrationCheck checkCalibration(const StereoCameras& cameras, cv::Size image_size,
                                           const InputNames& names, RectifiedBy rectified_by);

/// Returns the geometry of a calibration without errors. Throws InputError with the first error
/// otherwise.
CBMV_API const StereoGeometry& requireUsable(const CalibrationCheck& check);

}  // namespace cbmv
