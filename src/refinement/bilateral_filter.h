#pragma once

#include <opencv2/core.hpp>

#include "cbmv_stereo/disparity_range.h"

namespace cbmv {

/// Largest sigma of the bilateral filter, px.
constexpr float kMaxBilateralSigmaPx = 10.0F;

/// Bilateral filter (Žbontar & LeCun 2016, section 4.4) in separated form (Pham & van Vliet 2005):
/// first along the columns, then along the rows. Each disparity becomes a weighted mean of the
/// valid disparities that are within ±ceil(3 sigma) px and differ by less than `threshold_px` (px
/// of disparity). The weight is exp(−r² / 2 sigma²) with the distance r in the image. This takes 2
/// (2 ceil(3 sigma) + 1) steps per pixel instead of (2 ceil(3 sigma) + 1)². The errors of the
/// disparities are the same.
///
/// sigma_px = 0 copies. Invalid pixels stay invalid. Throws Error if sigma is negative or above
/// kMaxBilateralSigmaPx, or if the threshold is not positive. CV_32FC1. `filtered` must not share
/// memory with `disparity`. `padded` is scratch memory. Parallel over rows by oneTBB. The result
/// does not depend on the instruction set.
void bilateralFilter(const cv::Mat& disparity, const DisparityRange& range, float sigma_px,
                     float threshold_px, cv::Mat& padded, cv::Mat& filtered);

}  // namespace cbmv
