#pragma once

#include <opencv2/core.hpp>

#include "cbmv_stereo/volume/disparity_range.h"
#include "cbmv_stereo/volume/search_space.h"

namespace cbmv {

/// Sub-pixel enhancement as refineSubpixel, over a search space: a pixel also stays as it is where
/// d − 1 or d + 1 does not belong to its tile. `disparity` (CV_32FC1, of `view`) is changed in
/// place. Parallel over rows by oneTBB.
void refineWindowedSubpixel(const SearchSpace& space, const WindowedOptimizedVolume& costs,
                            View view, cv::Mat& disparity);

}  // namespace cbmv
