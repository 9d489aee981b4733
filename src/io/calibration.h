#pragma once

#include <string>

namespace cbmv {

/// A rectified pair of cameras as in Middlebury v3: both have the same focal length and cy.
struct StereoCalibration {
  double focal_length_px = 0.0;
  double cx_left = 0.0;   ///< px
  double cx_right = 0.0;  ///< px
  double cy = 0.0;        ///< px, of both cameras
  double baseline_m = 0.0;
  int width = 0;        ///< px
  int height = 0;       ///< px
  int disparities = 0;  ///< ndisp: true disparities are smaller

  /// Offset of disparities: depth = focal_length_px · baseline_m / (disparity + doffs()).
  double doffs() const { return cx_right - cx_left; }
};

/// Reads a Middlebury v3 calib.txt: lines `key=value`, with blanks allowed around key and value.
/// Uses cam0, cam1 (matrices [f 0 cx; 0 f cy; 0 0 1]), baseline (mm), width, height and ndisp.
/// Other keys are ignored, also doffs, which follows from the matrices. Without ndisp, disparities
/// is `default_disparities`, at most the width; if `default_disparities` is 0, ndisp is required.
/// Throws Error naming the file and the key if a key is missing or malformed.
StereoCalibration readMiddleburyCalibration(const std::string& path, int default_disparities = 0);

/// Writes these keys and doffs. Throws Error naming the file if it cannot be written.
void writeMiddleburyCalibration(const std::string& path, const StereoCalibration& calibration);

}  // namespace cbmv
