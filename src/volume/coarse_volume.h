#pragma once

#include <opencv2/core.hpp>

#include "base/volume.h"

#include "cbmv_stereo/disparity_range.h"

namespace cbmv {

/// The disparity range for images of half the size: d becomes ⌊d / 2⌋.
DisparityRange halveRange(const DisparityRange& range);

/// Halves the image size: means of four pixels, rounded to the nearest integer. CV_8UC1. A last odd
/// row or column is dropped. `gray` has at least 2 × 2 pixels. Parallel over rows by oneTBB.
void halveImage(const cv::Mat& gray, cv::Mat& half);

/// Halves the matching cost volume of the left view. A last odd row or column is dropped. For each
/// d, the costs of the four pixels (2 X, 2 Y) to (2 X + 1, 2 Y + 1) are averaged and rounded to the
/// nearest integer. The cost of (X, Y, D) is the lowest mean over d = 2 D and 2 D + 1, as far as
/// they are in `range`. `costs` has the disparity range `range` and at least 2 × 2 pixels. `half`
/// is resized to halveRange(range). Parallel over rows by oneTBB.
void halveVolume(const MatchingVolume& costs, const DisparityRange& range, MatchingVolume& half);

}  // namespace cbmv
