#include "optimization/windowed_winners.h"

#include <algorithm>
#include <cstddef>
#include <cstdlib>

#include <tbb/parallel_for.h>

#include "matching/cost_row.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "optimization/windowed_winners.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace cbmv {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Words = hn::CappedTag<std::uint16_t, kTileColumns>;

/// Updates `lowest` and `winners` (kTileColumns values each) with the entry of lowest cost for
/// every column of a tile. All entries must have their matches inside for all columns.
void findTileWinners(const std::uint16_t* costs, const std::int16_t* indices, int count,
                     std::uint16_t* lowest, std::uint16_t* winners) {
  const Words tag;
  const int lanes = static_cast<int>(hn::Lanes(tag));
  for (int c = 0; c < kTileColumns; c += lanes) {
    auto best = hn::LoadU(tag, lowest + c);
    auto winner = hn::LoadU(tag, winners + c);
    for (int k = 0; k < count; ++k) {
      const auto cost = hn::LoadU(tag, costs + k * kTileColumns + c);
      const auto is_better = hn::Lt(cost, best);
      best = hn::Min(best, cost);
      winner =
          hn::IfThenElse(is_better, hn::Set(tag, static_cast<std::uint16_t>(indices[k])), winner);
    }
    hn::StoreU(best, tag, lowest + c);
    hn::StoreU(winner, tag, winners + c);
  }
}

/// Updates the winners of neighboring right pixels with the costs of an entry. `index` is the index
/// of its disparity.
void lowerRight(const std::uint16_t* costs, std::uint16_t index, std::uint16_t* lowest,
                std::uint16_t* winners) {
  const Words tag;
  const int lanes = static_cast<int>(hn::Lanes(tag));
  for (int c = 0; c < kTileColumns; c += lanes) {
    const auto cost = hn::LoadU(tag, costs + c);
    const auto before = hn::LoadU(tag, lowest + c);
    const auto winner = hn::LoadU(tag, winners + c);
    const auto here = hn::Set(tag, index);
    // The smaller disparity wins ties. Disparities of the tiles come in any order.
    const auto is_better =
        hn::Or(hn::Lt(cost, before), hn::And(hn::Eq(cost, before), hn::Lt(here, winner)));
    hn::StoreU(hn::Min(cost, before), tag, lowest + c);
    hn::StoreU(hn::IfThenElse(is_better, here, winner), tag, winners + c);
  }
}

/// Finds the winners of the right pixels of a row, from the entries of its tiles whose matches are
/// inside for all columns. Processes every other tile in turn: the entries of a tile overlap, and a
/// vector load from recently stored memory has to wait until the stores reach the cache.
void lowerRightRow(const TileEntries* tiles, int count, int first_disparity, std::uint16_t* lowest,
                   std::uint16_t* winners) {
  for (const int first_tile : {0, 1}) {
    bool any = true;
    for (int n = 0; any; ++n) {
      any = false;
      for (int t = first_tile; t < count; t += 2) {
        const int k = tiles[t].begin + n;
        if (k < tiles[t].end) {
          any = true;
          const int shift = t * kTileColumns - first_disparity - tiles[t].indices[k];
          lowerRight(tiles[t].costs + static_cast<std::ptrdiff_t>(k) * kTileColumns,
                     static_cast<std::uint16_t>(tiles[t].indices[k]), lowest + shift,
                     winners + shift);
        }
      }
    }
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace cbmv
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cbmv {
namespace {

HWY_EXPORT(findTileWinners);
HWY_EXPORT(lowerRightRow);

constexpr std::uint16_t kNoCost = 0xffff;
constexpr std::uint16_t kNoIndex = 0x7fff;

/// Columns of a tile whose match at a disparity is inside, relative to the first column of the
/// tile.
ColumnSpan insideTile(int width, View view, int d, int first) {
  const ColumnSpan inside = matchedColumns(width, view == View::kLeft ? d : -d);
  const int begin = std::clamp(inside.begin - first, 0, kTileColumns);
  return {begin, std::clamp(inside.end - first, begin, kTileColumns)};
}

/// Entries [begin, end) of a tile's list whose matches are inside for all columns.
cv::Range wholeEntries(const SearchSpace& space, const SearchSpace::Tile& tile, View view,
                       int first) {
  const auto is_whole = [&](int k) {
    const ColumnSpan inside =
        insideTile(space.width(), view, space.range().min + tile.indices[k], first);
    return inside.begin == 0 && inside.end == kTileColumns;
  };
  int begin = 0;
  while (begin < tile.count && !is_whole(begin)) {
    ++begin;
  }
  int end = tile.count;  // the most frequent case
  while (end > begin && !is_whole(end - 1)) {
    --end;
  }
  return {begin, end};
}

struct TileWinners {
  std::uint16_t lowest[kTileColumns];
  std::uint16_t winners[kTileColumns];
};

/// Updates `found` with the given entries, whose matches are inside only for some columns.
void takeColumns(const SearchSpace& space, const SearchSpace::Tile& tile,
                 const std::uint16_t* costs, View view, int first, const cv::Range& entries,
                 TileWinners& found) {
  for (int k = entries.start; k < entries.end; ++k) {
    const ColumnSpan inside =
        insideTile(space.width(), view, space.range().min + tile.indices[k], first);
    for (int c = inside.begin; c < inside.end; ++c) {
      const std::uint16_t cost = costs[k * kTileColumns + c];
      if (cost < found.lowest[c]) {
        found.lowest[c] = cost;
        found.winners[c] = static_cast<std::uint16_t>(tile.indices[k]);
      }
    }
  }
}

TileWinners winnersOf(const SearchSpace& space, const SearchSpace::Tile& tile,
                      const std::uint16_t* costs, View view, int first) {
  TileWinners found;
  std::fill_n(found.lowest, kTileColumns, kNoCost);
  std::fill_n(found.winners, kTileColumns, kNoIndex);
  const cv::Range whole = wholeEntries(space, tile, view, first);
  takeColumns(space, tile, costs, view, first, {0, whole.start}, found);
  HWY_DYNAMIC_DISPATCH(findTileWinners)
  (costs + whole.start * kTileColumns, tile.indices + whole.start, whole.size(), found.lowest,
   found.winners);
  takeColumns(space, tile, costs, view, first, {whole.end, tile.count}, found);
  return found;
}

float disparityOf(std::uint16_t index, const DisparityRange& range) {
  return index == kNoIndex ? range.invalid() : static_cast<float>(range.min + index);
}

}  // namespace

void windowedWinners(const SearchSpace& space, const WindowedAggregatedVolume& costs, View view,
                     cv::Mat& disparity) {
  disparity.create(space.height(), space.width(), CV_32FC1);
  tbb::parallel_for(0, space.height(), [&](int y) {
    auto* out = disparity.ptr<float>(y);
    for (int t = 0; t < space.tiles(); ++t) {
      const SearchSpace::Tile tile = space.tile(y, t);
      const int first = t * kTileColumns;
      const TileWinners found = winnersOf(space, tile, costs.entry(tile.first_entry), view, first);
      const int columns = std::min(kTileColumns, space.width() - first);
      for (int c = 0; c < columns; ++c) {
        out[first + c] = disparityOf(found.winners[c], space.range());
      }
    }
  });
}

void windowedRightWinners(const SearchSpace& space, const WindowedAggregatedVolume& left_costs,
                          PerThread<WindowedRightWinnersRow>& scratch, cv::Mat& right_disparity) {
  const int width = space.width();
  const DisparityRange& range = space.range();
  right_disparity.create(space.height(), width, CV_32FC1);
  scratch.prepare([&](WindowedRightWinnersRow& row) {
    row.lowest.resize(static_cast<std::size_t>(width) + kTileColumns);
    row.winners.resize(row.lowest.size());
    row.tiles.resize(space.tiles());
  });
  tbb::parallel_for(0, space.height(), [&](int y) {
    WindowedRightWinnersRow& row = scratch.local();
    std::fill(row.lowest.begin(), row.lowest.end(), kNoCost);
    std::fill(row.winners.begin(), row.winners.end(), kNoIndex);
    for (int t = 0; t < space.tiles(); ++t) {
      const SearchSpace::Tile tile = space.tile(y, t);
      const int first = t * kTileColumns;
      const std::uint16_t* costs = left_costs.entry(tile.first_entry);
      const cv::Range whole = wholeEntries(space, tile, View::kLeft, first);
      row.tiles[t] = {costs, tile.indices, whole.start, whole.end};
      for (int k = 0; k < tile.count; ++k) {
        if (k >= whole.start && k < whole.end) {
          continue;
        }
        const int d = range.min + tile.indices[k];
        const ColumnSpan inside = insideTile(width, View::kLeft, d, first);
        for (int c = inside.begin; c < inside.end; ++c) {
          const int x = first + c - d;
          const std::uint16_t cost = costs[k * kTileColumns + c];
          const auto index = static_cast<std::uint16_t>(tile.indices[k]);
          if (cost < row.lowest[x] || (cost == row.lowest[x] && index < row.winners[x])) {
            row.lowest[x] = cost;
            row.winners[x] = index;
          }
        }
      }
    }
    HWY_DYNAMIC_DISPATCH(lowerRightRow)
    (row.tiles.data(), space.tiles(), range.min, row.lowest.data(), row.winners.data());
    auto* out = right_disparity.ptr<float>(y);
    for (int x = 0; x < width; ++x) {
      out[x] = disparityOf(row.winners[x], range);
    }
  });
}

}  // namespace cbmv
#endif  // HWY_ONCE
