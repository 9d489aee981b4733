#pragma once

#include <opencv2/core.hpp>

#include "cbmv_stereo/volume/disparity_range.h"

namespace cbmv {

/// Bilateral filter (Žbontar & LeCun 2016, section 4.4): mean of the valid disparities within
/// ±ceil(3 sigma) px that differ from the centre's by less than `threshold_px` (pixels of
/// disparity), weighted by exp(−r² / 2 sigma²) with r the distance in the image. sigma_px = 0
/// copies. Invalid pixels stay invalid. Throws Error if sigma is negative or the threshold is not
/// positive. CV_32FC1; `filtered` may not share memory with `disparity`. `padded` is scratch.
/// Parallel over rows by oneTBB.
void bilateralFilter(const cv::Mat& disparity, const DisparityRange& range, float sigma_px,
                     float threshold_px, cv::Mat& padded, cv::Mat& filtered);

}  // namespace cbmv
