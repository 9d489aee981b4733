#pragma once

#include <opencv2/core.hpp>

namespace cbmv {

/// Disparities (CV_32FC1) as a BGR picture in OpenCV's colour map TURBO: `lowest` and below blue,
/// `highest` and above red; `invalid` and values that are not finite are black. Where `highest` is
/// not above `lowest`, every pixel with a disparity gets the lowest colour.
cv::Mat colorizeDisparity(const cv::Mat& disparity, float lowest, float highest, float invalid);

/// Confidences (CV_32FC1) as a BGR picture in OpenCV's colour map VIRIDIS: 0 dark blue, 1 yellow;
/// values outside of [0, 1] are clamped, NaN is drawn as 0.
cv::Mat colorizeConfidence(const cv::Mat& confidence);

}  // namespace cbmv
