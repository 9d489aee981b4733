#pragma once

#include <cstdint>
#include <vector>

#include "base/per_thread.h"
#include "base/search_space.h"

namespace cbmv {

/// Turns the left view's volume into the right view's: right(x, d) = left(x + d, d) (Batsos et al.
/// 2018, section 3.3). A tile of the right view has every disparity at which one of its columns
/// matches a hypothesis of the left space inside of the left image; where the left space has no
/// such hypothesis, the cost is kOutsideCost. Holds its memory. Parallel over rows by oneTBB.
class WindowedRightView {
 public:
  void build(const SearchSpace& left_space, const WindowedMatchingVolume& left_costs,
             SearchSpace& right_space, WindowedMatchingVolume& right_costs);

 private:
  struct Row {
    std::vector<std::uint64_t> sets;    ///< for each right tile, its indices, one bit each
    std::vector<std::int32_t> entries;  ///< [tile][index]: number in the tile's list
  };

  PerThread<Row> rows_;
};

}  // namespace cbmv
