#pragma once

#include <opencv2/core.hpp>

namespace cbmv {

/// Non-occlusion map, computed from the true disparities of the left image (CV_32FC1, NaN or
/// infinity = unknown). Returns CV_8UC1: 255 where the disparity is known and both cameras see the
/// point, else 0.
///
/// A pixel (x, d) is projected to column x − d of the right image. It is occluded in two cases: the
/// column is more than half a pixel outside the image; or another pixel of the row, with a
/// disparity larger by more than 1 px, is projected less than one column away. The margin of 1 px
/// keeps slanted surfaces (up to 0.5 px of disparity per column) from occluding themselves.
cv::Mat visibleInBoth(const cv::Mat& truth);

}  // namespace cbmv
