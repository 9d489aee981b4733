#pragma once

#include <cstdint>
#include <vector>

#include "base/per_thread.h"
#include "base/search_space.h"

namespace cbmv {

/// Converts the volume of the left view to the right view: right(x, d) = left(x + d, d) (Batsos et
/// al. 2018, section 3.3). A tile of the right view has every disparity at which one of its columns
/// matches a hypothesis of the left space inside of the left image. The cost is kOutsideCost where
/// the left space does not have the hypothesis. The object keeps its memory. Parallel over rows by
/// oneTBB.
class WindowedRightView {
 public:
  void build(const SearchSpace& left_space, const WindowedMatchingVolume& left_costs,
             SearchSpace& right_space, WindowedMatchingVolume& right_costs);

 private:
  struct Row {
    std::vector<std::uint64_t> sets;    ///< indices of each right tile, one bit per index
    std::vector<std::int32_t> entries;  ///< [tile][index]: position in the tile's list
  };

  PerThread<Row> rows_;
};

}  // namespace cbmv
