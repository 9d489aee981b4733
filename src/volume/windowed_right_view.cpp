#include "volume/windowed_right_view.h"

#include <algorithm>
#include <cstddef>

#include <tbb/parallel_for.h>

#include "matching/cost_row.h"

namespace cbmv {
namespace {

constexpr int kWordBits = 64;

/// The right columns that the columns of a left tile match at disparity d, inside of both images.
ColumnSpan rightColumns(int width, int first, int d) {
  const ColumnSpan inside = matchedColumns(width, d);
  return {std::max(first, inside.begin) - d, std::min(first + kTileColumns, inside.end) - d};
}

}  // namespace

void WindowedRightView::build(const SearchSpace& left_space,
                              const WindowedMatchingVolume& left_costs, SearchSpace& right_space,
                              WindowedMatchingVolume& right_costs) {
  const int width = left_space.width();
  const DisparityRange& range = left_space.range();
  const int tiles = left_space.tiles();
  const int words = (range.count + kWordBits - 1) / kWordBits;
  rows_.prepare([&](Row& row) {
    row.sets.resize(static_cast<std::size_t>(tiles) * words);
    row.entries.resize(static_cast<std::size_t>(tiles) * range.count);
  });
  /// Calls use(tile, t, k, columns) for the entries that have a match.
  const auto for_entries = [&](int y, const auto& use) {
    for (int t = 0; t < tiles; ++t) {
      const SearchSpace::Tile tile = left_space.tile(y, t);
      for (int k = 0; k < tile.count; ++k) {
        const ColumnSpan columns =
            rightColumns(width, t * kTileColumns, range.min + tile.indices[k]);
        if (!columns.empty()) {
          use(tile, t, k, columns);
        }
      }
    }
  };
  right_space.build(left_space.height(), width, range, [&](int y, SearchSpace::Row& out) {
    Row& row = rows_.local();
    std::fill(row.sets.begin(), row.sets.end(), 0);
    for_entries(y, [&](const SearchSpace::Tile& tile, int /*t*/, int k, const ColumnSpan& columns) {
      const int index = tile.indices[k];
      for (const int t : {columns.begin / kTileColumns, (columns.end - 1) / kTileColumns}) {
        row.sets[static_cast<std::size_t>(t) * words + index / kWordBits] |= std::uint64_t{1}
                                                                             << (index % kWordBits);
      }
    });
    for (int t = 0; t < tiles; ++t) {
      for (int w = 0; w < words; ++w) {
        for (std::uint64_t rest = row.sets[static_cast<std::size_t>(t) * words + w]; rest != 0;
             rest &= rest - 1) {
          out.push(w * kWordBits + __builtin_ctzll(rest));
        }
      }
      out.endTile();
    }
  });
  right_costs.resize(right_space);
  tbb::parallel_for(0, left_space.height(), [&](int y) {
    Row& row = rows_.local();
    for (int t = 0; t < tiles; ++t) {
      const SearchSpace::Tile tile = right_space.tile(y, t);
      for (int k = 0; k < tile.count; ++k) {
        row.entries[static_cast<std::size_t>(t) * range.count + tile.indices[k]] = k;
        std::fill_n(right_costs.entry(tile.first_entry + k), kTileColumns, kOutsideCost);
      }
    }
    for_entries(y, [&](const SearchSpace::Tile& tile, int t, int k, const ColumnSpan& columns) {
      const int index = tile.indices[k];
      const std::uint8_t* costs = left_costs.entry(tile.first_entry + k);
      int x = columns.begin;
      while (x < columns.end) {
        const int right_tile = x / kTileColumns;
        const int end = std::min(columns.end, (right_tile + 1) * kTileColumns);
        const SearchSpace::Tile right = right_space.tile(y, right_tile);
        const int entry = row.entries[static_cast<std::size_t>(right_tile) * range.count + index];
        const int left_column = x + range.min + index - t * kTileColumns;
        std::copy_n(costs + left_column, end - x,
                    right_costs.entry(right.first_entry + entry) + x % kTileColumns);
        x = end;
      }
    });
  });
}

}  // namespace cbmv
