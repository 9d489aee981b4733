#pragma once

#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

#include "base/per_thread.h"
#include "base/search_space.h"

#include "cbmv_stereo/disparity_range.h"

namespace cbmv {

/// Finds the disparity of lowest cost for every pixel among the hypotheses of the space whose match
/// is inside of the other image. The smallest disparity wins ties. `disparity` becomes CV_32FC1
/// with whole pixels. It is range.invalid() where there is no hypothesis. Parallel over rows by
/// oneTBB.
void windowedWinners(const SearchSpace& space, const WindowedAggregatedVolume& costs, View view,
                     cv::Mat& disparity);

/// Entries [begin, end) of a tile's list whose matches are inside of the right image for all
/// columns.
struct TileEntries {
  const std::uint16_t* costs;  ///< at the first entry of the list
  const std::int16_t* indices;
  int begin;
  int end;
};

/// Memory for the winners of a row of the right image.
struct WindowedRightWinnersRow {
  std::vector<std::uint16_t> lowest;   ///< costs
  std::vector<std::uint16_t> winners;  ///< indices of disparities
  std::vector<TileEntries> tiles;
};

/// Winner-takes-all for the right image, from the costs of the left view. The winner of (x, y) is
/// the smallest d that minimizes left_costs(x + d, y, d).
void windowedRightWinners(const SearchSpace& space, const WindowedAggregatedVolume& left_costs,
                          PerThread<WindowedRightWinnersRow>& scratch, cv::Mat& right_disparity);

}  // namespace cbmv
