#pragma once

#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "cbmv_stereo/camera_calibration.h"
#include "cbmv_stereo/error.h"
#include "cbmv_stereo/export.h"

namespace cbmv {

/// The rectified stereo camera, in pixels of the images as they are sent (after binning and region
/// of interest).
struct StereoGeometry {
  double focal_length_px = 0;  ///< of the right camera, horizontal: f in Z = f T / d
  /// T > 0: the right camera lies to the right of the left one. left P[3] / fx − right P[3] / fx;
  /// a left camera with P[3] ≠ 0, as in rigs of several cameras, is normal. 0: not calibrated.
  double baseline_m = 0;
  /// cx_left − cx_right, 0 unless the rig is verged: a point at infinity is matched at this
  /// disparity, so it is taken off (once) of what is published.
  double disparity_offset_px = 0;
  double left_fx_px = 0;
  double left_fy_px = 0;
  double left_cx_px = 0;
  double left_cy_px = 0;
};

/// Who rectified the images, or will.
enum class RectifiedBy {
  kOthers,  ///< a driver or image_proc: it may have skipped images without distortion
  kFiles,   ///< whoever wrote image files: known to be rectified
  kUs,      ///< the images are raw and get rectified by K, D, R and P
};

/// Why a calibration cannot be used.
struct CalibrationError {
  InputFault fault;
  std::string text;
};

/// What checkCalibration finds. Each text names the camera, the entry and its value, what was
/// expected, and what to do.
struct CalibrationCheck {
  std::vector<CalibrationError> errors;  ///< not empty: the calibration gives no depth
  std::vector<std::string> warnings;     ///< depth is given, and is probably wrong
  StereoGeometry geometry;               ///< valid without errors
};

/// Checks the calibrations of both cameras against each other, and against the size of the images.
/// `names` are used in the texts.
///
/// Errors: P with entries that are not finite or focal lengths that are not positive; images of
/// another size than described (width and height exchanged, a region of interest or binning that
/// does not fit); no baseline; a negative one (cameras exchanged); R that is no rotation, for
/// images that we rectify by it.
///
/// Warnings: left and right P that differ in fx, fy or cy; fx other than fy; entries of P that are
/// 0 in a rectified pair (P[1], P[4], P[8], P[9], P[7]: the cameras differ in height, P[11]: in
/// depth); P[10] other than 1; baselines outside of 5 mm to 5 m; a principal point outside of the
/// image; unknown size (0 x 0: the image's is taken; not of files); R that is no rotation; and,
/// where others have rectified, D = 0 with R or P ≠ K to rectify by, which image_proc skips.
CBMV_API CalibrationCheck checkCalibration(const StereoCameras& cameras, cv::Size image_size,
                                           const InputNames& names, RectifiedBy rectified_by);

/// The geometry of a calibration that can be used. Throws InputError with the first error else.
CBMV_API const StereoGeometry& requireUsable(const CalibrationCheck& check);

}  // namespace cbmv
