#include "io/preview.h"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

namespace cbmv {
namespace {

/// Colors of 255 · clamp(position, 0, 1), rounded, in `map`. Black where `position` is NaN.
template <typename Position>
cv::Mat colorize(const cv::Mat& values, int map, Position position) {
  CV_Assert(values.type() == CV_32FC1);
  cv::Mat levels(values.size(), CV_8UC1);
  cv::Mat black(values.size(), CV_8UC1);
  for (int y = 0; y < values.rows; ++y) {
    for (int x = 0; x < values.cols; ++x) {
      const float p = position(values.at<float>(y, x));
      black.at<uchar>(y, x) = std::isnan(p) ? 255 : 0;
      levels.at<uchar>(y, x) =
          std::isnan(p) ? 0 : cv::saturate_cast<uchar>(255.0F * std::clamp(p, 0.0F, 1.0F));
    }
  }
  cv::Mat picture;
  cv::applyColorMap(levels, picture, map);
  picture.setTo(cv::Scalar::all(0), black);
  return picture;
}

}  // namespace

cv::Mat colorizeDisparity(const cv::Mat& disparity, float lowest, float highest, float invalid) {
  const float scale = highest > lowest ? 1.0F / (highest - lowest) : 0.0F;
  return colorize(disparity, cv::COLORMAP_TURBO, [=](float d) {
    return d == invalid || !std::isfinite(d) ? NAN : (d - lowest) * scale;
  });
}

cv::Mat colorizeConfidence(const cv::Mat& confidence) {
  return colorize(confidence, cv::COLORMAP_VIRIDIS,
                  [](float c) { return std::isnan(c) ? 0.0F : c; });
}

}  // namespace cbmv
