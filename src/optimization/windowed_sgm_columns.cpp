#include "optimization/windowed_sgm_columns.h"

#include <algorithm>
#include <array>

#include <hwy/cache_control.h>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "optimization/windowed_sgm_columns.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

#include "optimization/windowed_sgm_paths-inl.h"

#ifndef CBMV_OPTIMIZATION_WINDOWED_SGM_COLUMNS_ONCE
#define CBMV_OPTIMIZATION_WINDOWED_SGM_COLUMNS_ONCE
namespace cbmv {
namespace {

/// Steps of the paths of a block of tiles.
template <typename Cost>
struct ColumnRun {
  const PathSetup& setup;
  const WindowedVolume<Cost>& costs;
  WindowedAggregatedVolume& sums;
  cv::Range tiles;
  int direction;  ///< 1: downward, -1: upward
  ColumnFront& front;
};

}  // namespace
}  // namespace cbmv
#endif

HWY_BEFORE_NAMESPACE();
namespace cbmv {
namespace HWY_NAMESPACE {
namespace {

using Tag = hn::CappedTag<std::uint16_t, kTileColumns>;
using V = hn::Vec<Tag>;
using Mask = hn::Mask<Tag>;

/// One step of the paths of some columns of a tile. Pointers are to the first of these columns.
template <typename Cost>
struct TileStep {
  SearchSpace::Tile tile;
  const Cost* costs;
  std::uint16_t* sums;
  PathSteps steps;
  const std::uint16_t* previous;
  std::uint16_t* current;
  std::uint16_t* lowest;
};

/// Adds path costs to the sums. With kLast, the sums become means.
template <bool kLast>
HWY_INLINE void addToSums(V costs, std::uint16_t* sums) {
  const Tag tag;
  const auto sum = hn::Add(hn::Load(tag, sums), costs);
  hn::Store(kLast ? hn::ShiftRight<2>(hn::Add(sum, hn::Set(tag, 2))) : sum, tag, sums);
}

/// Lanes whose steps are not zero.
HWY_INLINE Mask lanesOf(const std::int8_t* steps) {
  const hn::RebindToSigned<Tag> tag;
  const auto widened = hn::PromoteTo(tag, hn::LoadU(hn::Rebind<std::int8_t, Tag>(), steps));
  return hn::MaskFromVec(hn::BitCast(Tag(), widened));
}

/// Lanes where the surface rises by `rise` along the path.
HWY_INLINE Mask lanesThatRise(const std::int8_t* rises, int rise) {
  const hn::RebindToSigned<Tag> tag;
  const auto widened = hn::PromoteTo(tag, hn::LoadU(hn::Rebind<std::int8_t, Tag>(), rises));
  const auto found = hn::Eq(widened, hn::Set(tag, static_cast<std::int16_t>(rise)));
  return hn::MaskFromVec(hn::BitCast(Tag(), hn::VecFromMask(tag, found)));
}

/// Penalties per lane. `edges` are the edges of one image, `other_edges` is the number of edges of
/// the other image.
HWY_INLINE V penaltiesOf(const std::array<std::int16_t, 3>& penalties, Mask edges,
                         int other_edges) {
  const Tag tag;
  return hn::IfThenElse(edges, hn::Set(tag, static_cast<std::uint16_t>(penalties[other_edges + 1])),
                        hn::Set(tag, static_cast<std::uint16_t>(penalties[other_edges])));
}

/// Path costs from the costs of the predecessors, which start at `previous`. With kRising, the path
/// continues at the adjacent disparity where the surface `rises` or `falls`.
template <bool kRising>
HWY_INLINE V extendPaths(V matching, const std::uint16_t* previous, V lowest, V p1, V p2,
                         [[maybe_unused]] Mask rises, [[maybe_unused]] Mask falls) {
  const Tag tag;
  const auto level = hn::Load(tag, previous);
  const auto below = hn::Load(tag, previous - kTileColumns);
  const auto above = hn::Load(tag, previous + kTileColumns);
  if constexpr (kRising) {
    const auto along = hn::IfThenElse(rises, below, hn::IfThenElse(falls, above, level));
    const auto two_below = hn::Load(tag, previous - 2 * kTileColumns);
    const auto two_above = hn::Load(tag, previous + 2 * kTileColumns);
    const auto lower = hn::IfThenElse(rises, two_below, hn::IfThenElse(falls, level, below));
    const auto upper = hn::IfThenElse(rises, level, hn::IfThenElse(falls, two_above, above));
    return pathCosts(matching, along, hn::Min(lower, upper), lowest, p1, p2);
  } else {
    return pathCosts(matching, level, hn::Min(below, above), lowest, p1, p2);
  }
}

template <bool kLast, bool kRising, typename Cost>
HWY_INLINE void extendTile(const TileStep<Cost>& step, const SgmPenalties& penalties, Mask rises,
                           Mask falls) {
  const Tag tag;
  const auto edges = lanesOf(step.steps.reference_edges);
  const auto p1 = penaltiesOf(penalties.p1, edges, 0);
  const auto p2 = penaltiesOf(penalties.p2, edges, 0);
  const auto p1_at_edge = penaltiesOf(penalties.p1, edges, 1);
  const auto p2_at_edge = penaltiesOf(penalties.p2, edges, 1);
  const auto lowest_previous = hn::Load(tag, step.lowest);
  auto lowest = hn::Set(tag, kNoPath);
  for (int i = 0; i < step.tile.count; ++i) {
    const std::ptrdiff_t index = step.tile.indices[i];
    const auto other_edges = lanesOf(step.steps.other_edges + step.steps.slope * index);
    const auto cost = extendPaths<kRising>(
        loadWidened(tag, step.costs + i * kTileColumns), step.previous + index * kTileColumns,
        lowest_previous, hn::IfThenElse(other_edges, p1_at_edge, p1),
        hn::IfThenElse(other_edges, p2_at_edge, p2), rises, falls);
    lowest = hn::Min(lowest, cost);
    hn::Store(cost, tag, step.current + index * kTileColumns);
    addToSums<kLast>(cost, step.sums + i * kTileColumns);
  }
  hn::Store(lowest, tag, step.lowest);
}

/// Processes the first pixels of paths.
template <bool kLast, typename Cost>
HWY_INLINE void startTile(const TileStep<Cost>& step) {
  const Tag tag;
  auto lowest = hn::Set(tag, kNoPath);
  for (int i = 0; i < step.tile.count; ++i) {
    const auto cost = loadWidened(tag, step.costs + i * kTileColumns);
    lowest = hn::Min(lowest, cost);
    hn::Store(cost, tag, step.current + step.tile.indices[i] * kTileColumns);
    addToSums<kLast>(cost, step.sums + i * kTileColumns);
  }
  hn::Store(lowest, tag, step.lowest);
}

/// Uses a faster variant where no surface rises or falls, which is the usual case.
template <bool kLast, typename Cost>
HWY_INLINE void extendTile(const TileStep<Cost>& step, const SgmPenalties& penalties,
                           int direction) {
  const auto rises = lanesThatRise(step.steps.rises, direction);
  const auto falls = lanesThatRise(step.steps.rises, -direction);
  if (hn::AllFalse(Tag(), hn::Or(rises, falls))) {
    extendTile<kLast, false>(step, penalties, rises, falls);
  } else {
    extendTile<kLast, true>(step, penalties, rises, falls);
  }
}

void forget(const SearchSpace::Tile& tile, std::uint16_t* costs) {
  const Tag tag;
  for (int i = 0; i < tile.count; ++i) {
    for (int column = 0; column < kTileColumns; column += static_cast<int>(hn::Lanes(tag))) {
      hn::Store(hn::Set(tag, kNoPath), tag, costs + tile.indices[i] * kTileColumns + column);
    }
  }
}

/// Adds tile t of row y to the paths. The previous row of the paths is y - direction.
template <bool kLast, typename Cost>
HWY_INLINE void addTile(const ColumnRun<Cost>& run, int y, const PathSteps& steps, int t) {
  const SearchSpace& space = *run.setup.space;
  const int before = y - run.direction;
  const auto previous = before >= 0 && before < space.height() ? space.tile(before, t)
                                                               : SearchSpace::Tile{nullptr, 0, 0};
  const auto tile = space.tile(y, t);
  const int n = t - run.tiles.start;
  std::uint16_t* previous_costs = run.front.costs(n, y + 1);
  for (int column = 0; column < kTileColumns; column += static_cast<int>(hn::Lanes(Tag()))) {
    const TileStep<Cost> step = {tile,
                                 run.costs.entry(tile.first_entry) + column,
                                 run.sums.entry(tile.first_entry) + column,
                                 steps.from(t * kTileColumns + column),
                                 previous_costs + column,
                                 run.front.costs(n, y) + column,
                                 run.front.lowest(n) + column};
    if (previous.count == 0) {
      startTile<kLast>(step);
    } else {
      extendTile<kLast>(step, run.setup.penalties, run.direction);
    }
  }
  forget(previous, previous_costs);
}

template <typename Value>
HWY_INLINE void prefetch(const Value* begin, const Value* end) {
  for (; begin < end; begin += 64 / sizeof(Value)) {
    hwy::Prefetch(begin);
  }
}

/// Prefetching pays for tiles with at least this number of hypotheses.
constexpr std::size_t kLongList = 32;

/// Prefetches the hypotheses of a row. They are contiguous, but far from those of the previous row.
template <typename Cost>
HWY_INLINE void prefetchRow(const ColumnRun<Cost>& run, int y) {
  const SearchSpace& space = *run.setup.space;
  if (y < 0 || y >= space.height()) {
    return;
  }
  const auto first = space.tile(y, run.tiles.start);
  const auto last = space.tile(y, run.tiles.end - 1);
  const std::size_t end = last.first_entry + last.count;
  if (end - first.first_entry >= kLongList * run.tiles.size()) {
    prefetch(run.costs.entry(first.first_entry), run.costs.entry(end));
    prefetch(run.sums.entry(first.first_entry), run.sums.entry(end));
  }
}

/// Adds `rows` rows from row `first` on in the direction of the run.
template <bool kLast, typename Cost>
HWY_INLINE void addRows(const ColumnRun<Cost>& run, int first, int rows) {
  for (int n = 0; n < rows; ++n) {
    const int y = first + n * run.direction;
    // The step from above is stored in the row itself, the step from below is stored in the row
    // below.
    const int lower = std::min(run.direction > 0 ? y : y + 1, run.setup.space->height() - 1);
    const PathSteps steps = run.setup.steps.row(lower);
    prefetchRow(run, y + run.direction);
    for (int t = run.tiles.start; t < run.tiles.end; ++t) {
      addTile<kLast>(run, y, steps, t);
    }
  }
}

void addRowsOfBytes(const ColumnRun<std::uint8_t>& run, int first, int rows) {
  addRows<false>(run, first, rows);
}
void addRowsOfWords(const ColumnRun<std::uint16_t>& run, int first, int rows) {
  addRows<false>(run, first, rows);
}
void averageRowsOfBytes(const ColumnRun<std::uint8_t>& run, int first, int rows) {
  addRows<true>(run, first, rows);
}
void averageRowsOfWords(const ColumnRun<std::uint16_t>& run, int first, int rows) {
  addRows<true>(run, first, rows);
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace cbmv
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cbmv {
namespace {

HWY_EXPORT(addRowsOfBytes);
HWY_EXPORT(addRowsOfWords);
HWY_EXPORT(averageRowsOfBytes);
HWY_EXPORT(averageRowsOfWords);

void addRows(const ColumnRun<std::uint8_t>& run, const cv::Range& rows) {
  HWY_DYNAMIC_DISPATCH(addRowsOfBytes)(run, rows.start, rows.size());
}
void addRows(const ColumnRun<std::uint16_t>& run, const cv::Range& rows) {
  HWY_DYNAMIC_DISPATCH(addRowsOfWords)(run, rows.start, rows.size());
}
void averageRowsUpwards(const ColumnRun<std::uint8_t>& run, int rows) {
  HWY_DYNAMIC_DISPATCH(averageRowsOfBytes)(run, rows - 1, rows);
}
void averageRowsUpwards(const ColumnRun<std::uint16_t>& run, int rows) {
  HWY_DYNAMIC_DISPATCH(averageRowsOfWords)(run, rows - 1, rows);
}

}  // namespace

void ColumnFront::resize(int tiles, int disparities) {
  tiles_ = tiles;
  stride_ = (disparities + 4) * kTileColumns;
  costs_.assign(2 * tiles * stride_, kNoPath);
  lowest_.resize(tiles * kTileColumns);
}

void ColumnPaths::resize(const PathSetup& setup, const cv::Range& tiles) {
  setup_ = &setup;
  tiles_ = tiles;
  front_.resize(tiles.size(), setup.space->range().count);
}

template <typename Cost>
void ColumnPaths::runDown(const WindowedVolume<Cost>& costs, const cv::Range& rows,
                          WindowedAggregatedVolume& sums) {
  addRows(ColumnRun<Cost>{*setup_, costs, sums, tiles_, 1, front_}, rows);
}

// The front still has the last row. The first row of the paths from below overwrites it.
template <typename Cost>
void ColumnPaths::runUp(const WindowedVolume<Cost>& costs, WindowedAggregatedVolume& sums) {
  averageRowsUpwards(ColumnRun<Cost>{*setup_, costs, sums, tiles_, -1, front_},
                     setup_->space->height());
}

template void ColumnPaths::runDown(const WindowedMatchingVolume&, const cv::Range&,
                                   WindowedAggregatedVolume&);
template void ColumnPaths::runDown(const WindowedAggregatedVolume&, const cv::Range&,
                                   WindowedAggregatedVolume&);
template void ColumnPaths::runUp(const WindowedMatchingVolume&, WindowedAggregatedVolume&);
template void ColumnPaths::runUp(const WindowedAggregatedVolume&, WindowedAggregatedVolume&);

}  // namespace cbmv
#endif  // HWY_ONCE
