#pragma once

#include <opencv2/core.hpp>

#include "base/search_space.h"
#include "optimization/winner_takes_all.h"

namespace cbmv {

/// What the winners of the left view say, CV_32FC1 but for the margin.
struct WinnerMaps {
  cv::Mat& winners;     ///< whole pixels; range.invalid() without a hypothesis
  cv::Mat& disparity;   ///< the same, with sub-pixel enhancement where that is switched on
  cv::Mat& confidence;  ///< 1 − matching cost / 255 of the winner; 0 without one
  cv::Mat& margin;      ///< CV_16UC1, as by winnerMargins, over the disparities of the tile
};

/// Winner takes all, confidence, margin and sub-pixel enhancement of the left view in one pass over
/// the costs. A winner is the cheapest disparity of the pixel's tile whose match lies inside of the
/// right image, the smallest one on ties. It is enhanced as by refineSubpixel, where the tile has
/// d − 1 and d + 1, too. Both volumes are of `space`. Parallel over rows by oneTBB.
void windowedWinnerMaps(const SearchSpace& space, const WindowedOptimizedVolume& costs,
                        const WindowedMatchingVolume& matching_costs, bool subpixel,
                        const WinnerMaps& maps);

}  // namespace cbmv
