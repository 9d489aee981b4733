#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <variant>
#include <vector>

#include "base/search_space.h"
#include "base/volume.h"

namespace cbmv {

/// Half-open interval of columns.
struct ColumnSpan {
  int begin = 0;
  int end = 0;
  bool empty() const { return begin >= end; }
};

/// Left columns x whose match x − d is inside of the right image.
inline ColumnSpan matchedColumns(int width, int d) {
  return {std::max(0, d), std::min(width, width + d)};
}

/// Matching costs of the hypotheses of one image row, laid out [place][column of the tile] (see
/// RowEntries). At one disparity, neighbors in either view are neighbors in memory. Costs of
/// hypotheses whose match is outside of the right image are unspecified. `Cost` is the narrowest
/// type for the costs of a matcher. kWritableBeyond costs after the last one may be written.
template <typename Cost>
class CostRow {
 public:
  static constexpr std::size_t kWritableBeyond = 64;

  /// Makes room for `entries` entries. Contents are unspecified afterwards. Never frees memory.
  void resize(std::size_t entries) {
    const std::size_t size = entries * kTileColumns + kWritableBeyond;
    if (costs_.size() < size) {
      costs_.resize(size);
    }
  }
  Cost* entry(int place) { return costs_.data() + static_cast<std::size_t>(place) * kTileColumns; }
  const Cost* entry(int place) const {
    return costs_.data() + static_cast<std::size_t>(place) * kTileColumns;
  }

 private:
  std::vector<Cost, CacheLineAllocator<Cost>> costs_;
};

/// A row of costs from any matcher.
using CostRowPointer = std::variant<const CostRow<std::uint8_t>*, const CostRow<std::uint16_t>*,
                                    const CostRow<float>*>;

}  // namespace cbmv
