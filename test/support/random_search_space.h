#pragma once

#include <random>

#include "base/search_space.h"

namespace cbmv::test {

/// A search space whose tiles have windows that vary along the row, plus single disparities. Some
/// tiles have no hypotheses.
inline SearchSpace makeSearchSpace(int height, int width, const DisparityRange& range,
                                   std::uint32_t seed) {
  SearchSpace space;
  space.build(height, width, range, [&](int y, SearchSpace::Row& row) {
    std::mt19937 random(seed + static_cast<std::uint32_t>(y));
    const auto draw = [&](int lowest, int highest) {
      return std::uniform_int_distribution<int>(lowest, highest)(random);
    };
    for (int t = 0; t < space.tiles(); ++t) {
      const int begin = draw(0, range.count - 1);
      const int end = draw(0, 9) == 0 ? begin : std::min(range.count, begin + draw(1, 12));
      for (int i = 0; i < range.count; ++i) {
        if ((i >= begin && i < end) || (begin < end && draw(0, 19) == 0)) {
          row.push(i);
        }
      }
      row.endTile();
    }
  });
  return space;
}

}  // namespace cbmv::test
