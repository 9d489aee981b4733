#pragma once

#include <opencv2/core.hpp>

#include "cbmv_stereo/disparity_label.h"
#include "cbmv_stereo/disparity_range.h"

namespace cbmv {

/// Left-right consistency check (Mei et al. 2011, section 2.4; Žbontar & LeCun 2016, section 4.3)
/// for the left view, with D_L(x) = d:
/// - match if |d − D_R(x − d)| ≤ max_difference_px;
/// - otherwise mismatched if |d' − D_R(x − d')| ≤ max_difference_px for another d' of the range;
/// - otherwise occluded.
///
/// Columns are rounded to the nearest pixel (std::lround). Columns outside of the right image and
/// invalid pixels of either image agree with nothing. d' are whole pixels and are also tested for
/// invalid pixels of the left image.
///
/// Both disparities are CV_32FC1 of the same size; range.invalid() marks invalid pixels. `labels`
/// becomes CV_8UC1 of Label. Parallel over rows by oneTBB.
void leftRightCheck(const cv::Mat& left_disparity, const cv::Mat& right_disparity,
                    const DisparityRange& range, float max_difference_px, cv::Mat& labels);

}  // namespace cbmv
