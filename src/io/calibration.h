#pragma once

#include <string>

namespace cbmv {

/// A rectified pair of cameras as Middlebury v3 describes it: same focal length and centre row.
struct StereoCalibration {
  double focal_length_px = 0.0;
  double cx_left = 0.0;   ///< column of the principal point, px
  double cx_right = 0.0;  ///< column of the principal point, px
  double cy = 0.0;        ///< row of both principal points, px
  double baseline_m = 0.0;
  int width = 0;        ///< px
  int height = 0;       ///< px
  int disparities = 0;  ///< ndisp: true disparities are below this

  /// Offset of disparities: depth = focal_length_px · baseline_m / (disparity + doffs()).
  double doffs() const { return cx_right - cx_left; }
};

/// Reads a Middlebury v3 calib.txt: lines `key=value`, blanks anywhere around key and value. Used
/// are cam0, cam1 (matrices [f 0 cx; 0 f cy; 0 0 1]), baseline (mm), width, height and ndisp; other
/// keys are skipped, doffs among them as it follows from the matrices. Where ndisp is absent,
/// disparities is `default_disparities`, at most the width; 0: ndisp must be there.
/// Throws Error naming the file and the key when one is missing or malformed.
StereoCalibration readMiddleburyCalibration(const std::string& path, int default_disparities = 0);

/// Writes those keys and doffs. Throws Error naming the file when it cannot be written.
void writeMiddleburyCalibration(const std::string& path, const StereoCalibration& calibration);

}  // namespace cbmv
