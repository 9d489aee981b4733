#pragma once

#include <opencv2/core.hpp>

#include "cbmv_stereo/disparity_range.h"

namespace cbmv {

/// Largest sigma of the bilateral filter, px.
constexpr float kMaxBilateralSigmaPx = 10.0F;

/// Bilateral filter (Žbontar & LeCun 2016, section 4.4), separated (Pham & van Vliet 2005): first
/// along the columns, then along the rows, each disparity becomes the mean of the valid ones within
/// ±ceil(3 sigma) px that differ from it by less than `threshold_px` (pixels of disparity),
/// weighted by exp(−r² / 2 sigma²) with r the distance in the image. This takes 2 (2 ceil(3 sigma)
/// + 1) steps a pixel in place of the square of it, at the same errors of the disparities.
///
/// sigma_px = 0 copies. Invalid pixels stay invalid. Throws Error if sigma is negative or
/// above kMaxBilateralSigmaPx, or the threshold is not positive. CV_32FC1; `filtered` may not share
/// memory with `disparity`. `padded` is scratch. Parallel over rows by oneTBB; the result does not
/// depend on the instruction set.
void bilateralFilter(const cv::Mat& disparity, const DisparityRange& range, float sigma_px,
                     float threshold_px, cv::Mat& padded, cv::Mat& filtered);

}  // namespace cbmv
