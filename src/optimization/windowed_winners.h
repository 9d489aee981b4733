#pragma once

#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

#include "base/per_thread.h"
#include "base/search_space.h"

#include "cbmv_stereo/disparity_range.h"

namespace cbmv {

/// Cheapest disparity of every pixel among the hypotheses of the space whose match lies inside of
/// the other image; the smallest such disparity on ties. `disparity` becomes CV_32FC1 of whole
/// pixels; range.invalid() where there is none. Parallel over rows by oneTBB.
void windowedWinners(const SearchSpace& space, const WindowedOptimizedVolume& costs, View view,
                     cv::Mat& disparity);

/// Entries of a tile that lie inside of the right image whole: [begin, end) of its list.
struct TileEntries {
  const std::uint16_t* costs;  ///< of the first entry of the list
  const std::int16_t* indices;
  int begin;
  int end;
};

/// Memory for the winners of a row of the right image.
struct RightWinnersRow {
  std::vector<std::uint16_t> lowest;   ///< costs
  std::vector<std::uint16_t> winners;  ///< indices of disparities
  std::vector<TileEntries> tiles;
};

/// The same for the pixels of the right image, from the costs of the left view: the winner of
/// (x, y) is the smallest d that minimizes left_costs(x + d, y, d).
void windowedWinnersAcross(const SearchSpace& space, const WindowedOptimizedVolume& left_costs,
                           PerThread<RightWinnersRow>& scratch, cv::Mat& right_disparity);

}  // namespace cbmv
