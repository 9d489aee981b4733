#pragma once

#include <opencv2/core.hpp>

#include "cbmv_stereo/disparity_range.h"

namespace cbmv {

/// The strip at the left border that the right camera does not see becomes kOcclusion. What passed
/// the left-right check there is wrong: no hypothesis of the true disparity exists.
///
/// The strip ends where the left border of the right image is seen: at the largest x + D_R(x) over
/// the first five columns x, less 4 px, then the median over nine rows (the lower one of two; rows
/// without a disparity or beyond the image do not count). Pixels keep the label kMatch that match
/// more than a sixteenth of the width inside the right image: background that the right camera sees
/// past a thin object at its left border.
///
/// `left_disparity` and `right_disparity` are CV_32FC1, px, with range.invalid() as the invalid
/// mark; `labels` is CV_8UC1 of Label, from leftRightCheck. Parallel over rows by oneTBB.
void occludeLeftBorder(const cv::Mat& left_disparity, const cv::Mat& right_disparity,
                       const DisparityRange& range, cv::Mat& labels);

}  // namespace cbmv
