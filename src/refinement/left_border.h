#pragma once

#include <opencv2/core.hpp>

#include "cbmv_stereo/disparity_range.h"

namespace cbmv {

/// Sets the strip at the left border that the right camera does not see to kOcclusion. Matches that
/// passed the left-right consistency check there are wrong, because the true disparity has no
/// hypothesis.
///
/// The strip ends at the left column that matches the left border of the right image: the largest x
/// + D_R(x) over the first five columns x, minus 4 px, then the median over nine rows (the lower of
/// two middle values; rows without a disparity or beyond the image do not count). A pixel keeps the
/// label kMatch if its match is more than 1/16 of the width inside of the right image: this is
/// background that the right camera sees past a thin object at its left border.
///
/// `left_disparity` and `right_disparity` are CV_32FC1 in px. range.invalid() marks invalid pixels.
/// `labels` is CV_8UC1 of Label, from leftRightCheck. Parallel over rows by oneTBB.
void occludeLeftBorder(const cv::Mat& left_disparity, const cv::Mat& right_disparity,
                       const DisparityRange& range, cv::Mat& labels);

}  // namespace cbmv
