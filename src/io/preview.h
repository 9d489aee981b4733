#pragma once

#include <opencv2/core.hpp>

namespace cbmv {

/// Draws disparities (CV_32FC1) as a BGR image in OpenCV's color map TURBO: `lowest` and below are
/// blue, `highest` and above are red. `invalid` and values that are not finite are black. If
/// `highest` ≤ `lowest`, every pixel with a disparity has the lowest color.
cv::Mat colorizeDisparity(const cv::Mat& disparity, float lowest, float highest, float invalid);

/// Draws confidences (CV_32FC1) as a BGR image in OpenCV's color map VIRIDIS: 0 is dark blue, 1 is
/// yellow. Values outside of [0, 1] are clamped. NaN is drawn as 0.
cv::Mat colorizeConfidence(const cv::Mat& confidence);

}  // namespace cbmv
