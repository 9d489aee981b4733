#pragma once

#include <opencv2/core.hpp>

#include "cbmv_stereo/disparity_range.h"

namespace cbmv {

/// Largest window size.
constexpr int kMaxMedianSizePx = 15;

/// Median of the valid disparities in a size_px × size_px window. size_px is odd and in [1,
/// kMaxMedianSizePx], otherwise throws Error; 1 copies. At the image border, the window is
/// truncated. Of an even number of valid values, the lower middle value is used. Invalid pixels
/// stay invalid. CV_32FC1. `filtered` must not share memory with `disparity`. `padded` is scratch
/// memory. Parallel over rows by oneTBB.
void medianFilter(const cv::Mat& disparity, const DisparityRange& range, int size_px,
                  cv::Mat& padded, cv::Mat& filtered);

}  // namespace cbmv
