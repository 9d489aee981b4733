#pragma once

#include <opencv2/core.hpp>

#include "base/volume.h"

#include "cbmv_stereo/disparity_range.h"

namespace cbmv {

/// The disparities of `range` in images of half the size: every d becomes ⌊d / 2⌋.
DisparityRange halveRange(const DisparityRange& range);

/// The image at half the size, CV_8UC1, last odd row and column left out: means of four pixels,
/// rounded to the nearest. `grey` is at least 2 × 2 pixels large. Parallel over rows by oneTBB.
void halveImage(const cv::Mat& grey, cv::Mat& half);

/// The matching volume of the left view at half the size, last odd row and column left out: the
/// cost of (X, Y, D) is the lowest, over those of d = 2 D and 2 D + 1 that are in `range`, of the
/// mean cost (rounded to the nearest) of d at the four pixels (2 X, 2 Y) to (2 X + 1, 2 Y + 1).
/// `costs` is over `range` and at least 2 × 2 pixels large, `half` over halveRange(range); it is
/// resized. Parallel over rows by oneTBB.
void halveVolume(const MatchingVolume& costs, const DisparityRange& range, MatchingVolume& half);

}  // namespace cbmv
