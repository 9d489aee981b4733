#include "cbmv_stereo/io/points.h"

#include <cmath>
#include <limits>

namespace cbmv {

cv::Mat toDepth(const cv::Mat& disparity, float invalid, const StereoCalibration& calibration) {
  const double scale = calibration.focal_length_px * calibration.baseline_m;
  cv::Mat_<float> depth = disparity.clone();
  for (float& value : depth) {
    const double shift = value + calibration.doffs();
    value = value != invalid && shift > 0 ? static_cast<float>(scale / shift)
                                          : std::numeric_limits<float>::quiet_NaN();
  }
  return depth;
}

std::vector<ColoredPoint> toPoints(const cv::Mat& depth, const cv::Mat& color,
                                   const StereoCalibration& calibration) {
  std::vector<ColoredPoint> points;
  const double f = calibration.focal_length_px;
  for (int y = 0; y < depth.rows; ++y) {
    for (int x = 0; x < depth.cols; ++x) {
      const float z = depth.at<float>(y, x);
      if (std::isfinite(z)) {
        const cv::Vec3b& bgr = color.at<cv::Vec3b>(y, x);
        points.push_back({static_cast<float>((x - calibration.cx_left) * z / f),
                          static_cast<float>((y - calibration.cy) * z / f), z, bgr[2], bgr[1],
                          bgr[0]});
      }
    }
  }
  return points;
}

}  // namespace cbmv
