#include "cbmv_stereo/points.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace cbmv {
namespace {

constexpr float kNone = std::numeric_limits<float>::quiet_NaN();

}  // namespace

cv::Mat toValidDisparity(const cv::Mat& disparity, float invalid, double disparity_offset_px) {
  cv::Mat_<float> valid = disparity.clone();
  for (float& value : valid) {
    value = value == invalid ? kNone : static_cast<float>(value - disparity_offset_px);
  }
  return valid;
}

cv::Mat toDepth(const cv::Mat& valid_disparity, const StereoGeometry& geometry) {
  const double scale = geometry.focal_length_px * geometry.baseline_m;
  cv::Mat_<float> depth = valid_disparity.clone();
  for (float& value : depth) {
    value = value > 0 ? static_cast<float>(scale / value) : kNone;
  }
  return depth;
}

cv::Mat toDepthSigma(const cv::Mat& valid_disparity, const cv::Mat& disparity_sigma,
                     const StereoGeometry& geometry) {
  CV_Assert(valid_disparity.type() == CV_32FC1 && disparity_sigma.type() == CV_32FC1);
  CV_Assert(valid_disparity.size() == disparity_sigma.size());
  const double scale = geometry.focal_length_px * geometry.baseline_m;
  cv::Mat_<float> sigma(valid_disparity.size());
  const cv::Mat_<float> disparities = valid_disparity;
  const cv::Mat_<float> disparity_sigmas = disparity_sigma;
  std::transform(disparities.begin(), disparities.end(), disparity_sigmas.begin(), sigma.begin(),
                 [scale](double d, double sigma_px) {
                   return d > 0 && sigma_px > 0 ? static_cast<float>(scale * sigma_px / (d * d))
                                                : kNone;
                 });
  return sigma;
}

cv::Vec3f toPoint(const StereoGeometry& geometry, int x, int y, float valid_disparity_px) {
  if (!(valid_disparity_px > 0)) {
    return cv::Vec3f::all(kNone);
  }
  const double z = geometry.focal_length_px * geometry.baseline_m / valid_disparity_px;
  return {static_cast<float>((x - geometry.left_cx_px) * z / geometry.left_fx_px),
          static_cast<float>((y - geometry.left_cy_px) * z / geometry.left_fy_px),
          static_cast<float>(z)};
}

std::vector<ColoredPoint> toPoints(const cv::Mat& valid_disparity, const cv::Mat& color,
                                   const StereoGeometry& geometry) {
  std::vector<ColoredPoint> points;
  for (int y = 0; y < valid_disparity.rows; ++y) {
    for (int x = 0; x < valid_disparity.cols; ++x) {
      const cv::Vec3f point = toPoint(geometry, x, y, valid_disparity.at<float>(y, x));
      if (std::isfinite(point[2])) {
        const cv::Vec3b& bgr = color.at<cv::Vec3b>(y, x);
        points.push_back({point[0], point[1], point[2], bgr[2], bgr[1], bgr[0]});
      }
    }
  }
  return points;
}

}  // namespace cbmv
