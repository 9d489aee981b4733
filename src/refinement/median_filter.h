#pragma once

#include <opencv2/core.hpp>

#include "cbmv_stereo/disparity_range.h"

namespace cbmv {

/// Largest window.
constexpr int kMaxMedianSizePx = 15;

/// Median of the valid disparities in a size_px × size_px window (odd, in [1, kMaxMedianSizePx],
/// else throws Error; 1 copies). At the image border the window is cut off. With an even number of
/// valid values, the lower of the two middle ones. Invalid pixels stay invalid. CV_32FC1;
/// `filtered` may not share memory with `disparity`. `padded` is scratch. Parallel over rows by
/// oneTBB.
void medianFilter(const cv::Mat& disparity, const DisparityRange& range, int size_px,
                  cv::Mat& padded, cv::Mat& filtered);

}  // namespace cbmv
