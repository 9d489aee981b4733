#pragma once

#include <opencv2/core.hpp>

#include "base/search_space.h"
#include "optimization/winner_takes_all.h"

namespace cbmv {

/// Maps of the winners of the left view, CV_32FC1 except the margin.
struct WinnerMaps {
  cv::Mat& winners;     ///< whole pixels; range.invalid() without a hypothesis
  cv::Mat& disparity;   ///< the winners, with subpixel enhancement if enabled
  cv::Mat& confidence;  ///< 1 − matching cost / 255 of the winner; 0 without a winner
  cv::Mat& margin;      ///< CV_16UC1, as winnerMargins, over the disparities of the tile
};

/// Winner-takes-all, confidence, margin and subpixel enhancement of the left view in one pass over
/// the costs. The winner of a pixel is the disparity of lowest cost in its tile whose match is
/// inside of the right image. The smallest disparity wins ties. Subpixel enhancement is as in
/// refineSubpixel, where the tile also has d − 1 and d + 1. Both volumes are of `space`. Parallel
/// over rows by oneTBB.
void windowedWinnerMaps(const SearchSpace& space, const WindowedAggregatedVolume& costs,
                        const WindowedMatchingVolume& matching_costs, bool subpixel,
                        const WinnerMaps& maps);

}  // namespace cbmv
