#include "optimization/windowed_sgm_rows.h"

#include <algorithm>
#include <utility>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "optimization/windowed_sgm_rows.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

#include "optimization/tile_transpose-inl.h"
#include "optimization/windowed_sgm_lanes-inl.h"
#include "optimization/windowed_sgm_paths-inl.h"

#ifndef CBMV_OPTIMIZATION_WINDOWED_SGM_ROWS_ONCE
#define CBMV_OPTIMIZATION_WINDOWED_SGM_ROWS_ONCE
namespace cbmv {
namespace {

/// A row of pixels.
template <typename Cost>
struct RowJob {
  const PathSetup& setup;
  const WindowedVolume<Cost>& costs;
  WindowedOptimizedVolume& sums;
  int y;
};

/// What a lane of a pixel holds before its path cost: a matching cost, and this bit where the other
/// image has an edge.
constexpr std::uint16_t kEdgeBit = 0x4000;
static_assert(kMaxPathCost < kEdgeBit);
/// A lane without a hypothesis: no path as it is and with a penalty on top.
constexpr std::uint16_t kNoHypothesis = 0xBFFF;
static_assert((kNoHypothesis & kEdgeBit) == 0 && kNoHypothesis > 2 * kMaxPathCost);

}  // namespace
}  // namespace cbmv
#endif

HWY_BEFORE_NAMESPACE();
namespace cbmv {
namespace HWY_NAMESPACE {
namespace {

using Tag = LineTag<std::uint16_t>;
using V = hn::Vec<Tag>;
using ColumnTag = hn::CappedTag<std::uint16_t, kTileColumns>;

/// Penalties in all lanes, by the number of images that have an edge.
struct PenaltyLanes {
  alignas(64) std::uint16_t p1[3][RowBuffer::kGap];
  alignas(64) std::uint16_t p2[3][RowBuffer::kGap];

  explicit PenaltyLanes(const SgmPenalties& penalties) {
    for (std::size_t edges = 0; edges < 3; ++edges) {
      std::fill_n(p1[edges], RowBuffer::kGap, static_cast<std::uint16_t>(penalties.p1[edges]));
      std::fill_n(p2[edges], RowBuffer::kGap, static_cast<std::uint16_t>(penalties.p2[edges]));
    }
  }
};

/// The path costs of some lanes of a pixel, which hold matching costs and edges. `edge`: 1 if the
/// reference image has one, else 0.
HWY_INLINE V extendLanes(const PenaltyLanes& penalties, int edge, const std::uint16_t* lanes,
                         V along, V beside, V lowest) {
  const Tag tag;
  const auto edge_bit = hn::Set(tag, kEdgeBit);
  const auto values = hn::Load(tag, lanes);
  const auto edges = hn::TestBit(values, edge_bit);
  const auto p1 = hn::IfThenElse(edges, hn::Load(tag, penalties.p1[edge + 1]),
                                 hn::Load(tag, penalties.p1[edge]));
  const auto p2 = hn::IfThenElse(edges, hn::Load(tag, penalties.p2[edge + 1]),
                                 hn::Load(tag, penalties.p2[edge]));
  return pathCosts(hn::AndNot(edge_bit, values), along, beside, lowest, p1, p2);
}

/// A path along a row, in one of both directions.
template <typename Cost>
class RowPath {
 public:
  RowPath(const RowJob<Cost>& job, const PenaltyLanes& penalties, int direction, RowBuffer& buffer)
      : job_(job), penalties_(penalties), direction_(direction), buffer_(buffer) {}

  /// Lays out a tile, which starts at the column `x`, and extends the path by its first pixel.
  HWY_INLINE void enter(int t) {
    const SearchSpace& space = *job_.setup.space;
    tile_ = space.tile(job_.y, t);
    columns_ = tile_.count == 0 ? 0 : std::min(kTileColumns, space.width() - t * kTileColumns);
    if (columns_ == 0) {
      return;
    }
    first_column_ = direction_ > 0 ? 0 : columns_ - 1;
    steps_ = job_.setup.steps.row(job_.y).from(t * kTileColumns + (direction_ > 0 ? 0 : 1));
    findRuns();
    fillEntries();
    fillPixels();
    takePrevious(rise(0));
    extendFirst();
  }

  /// Of the tile.
  int columns() const { return columns_; }
  bool fitsOneVector() const {
    // Rotations by two lanes must bring in lanes without a hypothesis.
    return lanes_ + 2 <= static_cast<int>(hn::Lanes(Tag()));
  }

  HWY_INLINE V lowest() const { return hn::Set(Tag(), lowest_); }
  HWY_INLINE void setLowest(V lowest) { lowest_ = hn::GetLane(lowest); }
  HWY_INLINE V firstCosts() const { return hn::Load(Tag(), pixel(0)); }

  /// Extends the path by the i-th pixel of a tile that fits one vector.
  HWY_INLINE void extendVector(int i, V& costs, V& lowest) {
    const Tag tag;
    const int rising = rise(i);
    if (HWY_UNLIKELY(rising != 0)) {
      costs = rising > 0 ? rotateUp(tag, costs) : rotateDown(tag, costs);
    }
    const auto beside = hn::Min(rotateUp(tag, costs), rotateDown(tag, costs));
    costs = extendLanes(penalties_, edge(i), pixel(i), costs, beside, lowest);
    hn::Store(costs, tag, pixel(i));
    lowest = lowestOfLanes(tag, costs);
  }

  /// The same for any tile.
  HWY_INLINE void extend(int i, V& lowest) {
    const Tag tag;
    const auto step = static_cast<int>(hn::Lanes(tag));
    const std::uint16_t* previous = pixel(i - 1) - rise(i);
    std::uint16_t* current = pixel(i);
    const int reference_edge = edge(i);
    auto lowest_cost = hn::Set(tag, kNoPath);
    for (int lane = 0; lane < lanes_; lane += step) {
      const auto beside =
          hn::Min(hn::LoadU(tag, previous + lane - 1), hn::LoadU(tag, previous + lane + 1));
      const auto costs = extendLanes(penalties_, reference_edge, current + lane,
                                     hn::LoadU(tag, previous + lane), beside, lowest);
      lowest_cost = hn::Min(lowest_cost, costs);
      hn::Store(costs, tag, current + lane);
    }
    lowest = lowestOfLanes(tag, lowest_cost);
  }

  /// Sets the sums of the tile, or adds the path costs to them.
  template <bool kAdd>
  HWY_INLINE void leave() {
    fresh_ = columns_ == 0;
    if (fresh_) {
      return;
    }
    keepLast();
    pixelsToLanes(buffer_.pixel(0), padded_lanes_, buffer_.stride, buffer_.entries.data());
    const ColumnTag tag;
    std::uint16_t* sums = job_.sums.entry(tile_.first_entry);
    for (std::size_t r = 0; r < buffer_.run_count; ++r) {
      const LaneRun& run = buffer_.runs[r];
      const std::uint16_t* entries = buffer_.entries.data() + run.lane * kTileColumns;
      for (int i = 0; i < run.length * kTileColumns; i += static_cast<int>(hn::Lanes(tag))) {
        const auto costs = hn::Load(tag, entries + i);
        hn::Store(kAdd ? hn::Add(hn::Load(tag, sums + i), costs) : costs, tag, sums + i);
      }
      sums += run.length * kTileColumns;
    }
  }

 private:
  std::uint16_t* pixel(int i) const { return buffer_.pixel(first_column_ + i * direction_); }
  int edge(int i) const { return -steps_.reference_edges[first_column_ + i * direction_]; }
  int rise(int i) const { return direction_ * steps_.rises[first_column_ + i * direction_]; }

  /// Runs are two lanes apart, or one if a single disparity lies between them: a path goes on at
  /// most two disparities away.
  HWY_INLINE void findRuns() {
    buffer_.runs.swap(buffer_.previous_runs);
    buffer_.previous_run_count = buffer_.run_count;
    LaneRun* runs = buffer_.runs.data();
    std::size_t count = 0;
    int next = tile_.indices[0];
    int lane = 0;
    runs[0] = {0, next, 0};
    for (int i = 0; i < tile_.count; ++i) {
      const int index = tile_.indices[i];
      if (index != next) {
        lane += std::min(index - next, 2);
        runs[++count] = {lane, index, 0};
      }
      ++runs[count].length;
      ++lane;
      next = index + 1;
    }
    buffer_.run_count = count + 1;
    lanes_ = lane;
    padded_lanes_ = (lane + kTransposeLanes - 1) / kTransposeLanes * kTransposeLanes;
  }

  /// [lane][column]
  HWY_INLINE void fillEntries() {
    const ColumnTag tag;
    const hn::RebindToSigned<ColumnTag> signed_tag;
    const hn::Rebind<std::int8_t, ColumnTag> edge_tag;
    const auto step = static_cast<int>(hn::Lanes(tag));
    const auto edge_bit = hn::Set(tag, kEdgeBit);
    const Cost* costs = job_.costs.entry(tile_.first_entry);
    for (std::size_t r = 0; r < buffer_.run_count; ++r) {
      const LaneRun& run = buffer_.runs[r];
      std::uint16_t* entry = buffer_.entries.data() + run.lane * kTileColumns;
      for (int i = 0; i < run.length; ++i) {
        const std::int8_t* edges = steps_.other_edges + steps_.slope * (run.index + i);
        for (int column = 0; column < kTileColumns; column += step) {
          const auto edge = hn::BitCast(
              tag, hn::PromoteTo(signed_tag, hn::LoadU(edge_tag, edges + column)));
          hn::Store(hn::Or(loadWidened(tag, costs + column), hn::And(edge, edge_bit)), tag,
                    entry + column);
        }
        costs += kTileColumns;
        entry += kTileColumns;
      }
      fillWithout(entry, 2 * kTileColumns);
    }
    std::uint16_t* end = buffer_.entries.data() + lanes_ * kTileColumns;
    fillWithout(end, (padded_lanes_ - lanes_) * kTileColumns);
  }

  HWY_INLINE void fillWithout(std::uint16_t* entry, int count) {
    const ColumnTag tag;
    for (int i = 0; i < count; i += static_cast<int>(hn::Lanes(tag))) {
      hn::Store(hn::Set(tag, kNoHypothesis), tag, entry + i);
    }
  }

  /// [column][lane], with lanes without a hypothesis behind the others, as far as a vector reaches.
  HWY_INLINE void fillPixels() {
    const Tag tag;
    for (int column = 0; column < kTileColumns; ++column) {
      hn::StoreU(hn::Set(tag, kNoHypothesis), tag, buffer_.pixel(column) + padded_lanes_);
    }
    lanesToPixels(buffer_.entries.data(), padded_lanes_, buffer_.stride, buffer_.pixel(0));
  }

  /// The costs of the last pixel, by disparity, for the next tile.
  HWY_INLINE void keepLast() {
    const Tag tag;
    const auto step = static_cast<int>(hn::Lanes(tag));
    const std::uint16_t* last = pixel(columns_ - 1);
    for (std::size_t r = 0; r < buffer_.run_count; ++r) {
      const LaneRun& run = buffer_.runs[r];
      std::uint16_t* out = buffer_.previous.data() + RowBuffer::kGap + run.index;
      for (int i = 0; i < run.length; i += step) {
        hn::BlendedStore(hn::LoadU(tag, last + run.lane + i), hn::FirstN(tag, run.length - i), tag,
                         out + i);
      }
    }
  }

  /// Along and beside of the new tile's lanes, from the costs kept by disparity, which are
  /// forgotten. Stores reach beyond the runs: later runs overwrite them, and of lanes without a
  /// hypothesis nothing matters.
  HWY_INLINE void takePrevious(int rising) {
    const Tag tag;
    const auto step = static_cast<int>(hn::Lanes(tag));
    std::uint16_t* previous = buffer_.previous.data() + RowBuffer::kGap;
    for (std::size_t r = 0; !fresh_ && r < buffer_.run_count; ++r) {
      const LaneRun& run = buffer_.runs[r];
      const std::uint16_t* in = previous + run.index - rising;
      for (int i = 0; i < run.length; i += step) {
        hn::StoreU(hn::LoadU(tag, in + i), tag, buffer_.along.data() + run.lane + i);
        hn::StoreU(hn::Min(hn::LoadU(tag, in + i - 1), hn::LoadU(tag, in + i + 1)), tag,
                   buffer_.beside.data() + run.lane + i);
      }
    }
    for (int lane = 0; fresh_ && lane < lanes_; lane += step) {
      // All costs zero, from which the step leads to L = C.
      lowest_ = 0;
      hn::Store(hn::Zero(tag), tag, buffer_.along.data() + lane);
    }
    for (std::size_t r = 0; r < buffer_.previous_run_count; ++r) {
      const LaneRun& run = buffer_.previous_runs[r];
      for (int i = 0; i < run.length; i += step) {
        hn::StoreU(hn::Set(tag, kNoPath), tag, previous + run.index + i);
      }
    }
  }

  HWY_INLINE void extendFirst() {
    const Tag tag;
    const auto step = static_cast<int>(hn::Lanes(tag));
    const auto lowest_previous = lowest();
    auto lowest_cost = hn::Set(tag, kNoPath);
    for (int lane = 0; lane < lanes_; lane += step) {
      const auto costs = extendLanes(penalties_, edge(0), pixel(0) + lane,
                                     hn::Load(tag, buffer_.along.data() + lane),
                                     hn::Load(tag, buffer_.beside.data() + lane), lowest_previous);
      lowest_cost = hn::Min(lowest_cost, costs);
      hn::Store(costs, tag, pixel(0) + lane);
    }
    setLowest(lowestOfLanes(tag, lowest_cost));
  }

  const RowJob<Cost>& job_;
  const PenaltyLanes& penalties_;
  const int direction_;  ///< 1: from the left, -1: from the right
  RowBuffer& buffer_;
  bool fresh_ = true;  ///< the next pixel is the first one of the path
  std::uint16_t lowest_ = 0;
  SearchSpace::Tile tile_{nullptr, 0, 0};
  int columns_ = 0;
  int first_column_ = 0;
  int lanes_ = 0;
  int padded_lanes_ = 0;
  PathSteps steps_{nullptr, nullptr, 0, nullptr};
};

/// Calls a(i) and b(i) in turns, since each waits for its result of the call before, for the second
/// and later pixels of the tiles.
template <typename A, typename B>
HWY_INLINE void inTurns(int columns_a, int columns_b, const A& a, const B& b) {
  const int both = std::min(columns_a, columns_b);
  for (int i = 1; i < both; ++i) {
    a(i);
    b(i);
  }
  for (int i = std::max(both, 1); i < columns_a; ++i) {
    a(i);
  }
  for (int i = std::max(both, 1); i < columns_b; ++i) {
    b(i);
  }
}

template <typename Cost>
HWY_INLINE void walkTiles(RowPath<Cost>& left, RowPath<Cost>& right) {
  auto left_lowest = left.lowest();
  auto right_lowest = right.lowest();
#if !HWY_HAVE_SCALABLE
  if (left.fitsOneVector() && right.fitsOneVector()) {
    auto left_costs = left.firstCosts();
    auto right_costs = right.firstCosts();
    inTurns(
        left.columns(), right.columns(),
        [&](int i) HWY_ATTR { left.extendVector(i, left_costs, left_lowest); },
        [&](int i) HWY_ATTR { right.extendVector(i, right_costs, right_lowest); });
  } else
#endif
  {
    inTurns(
        left.columns(), right.columns(), [&](int i) HWY_ATTR { left.extend(i, left_lowest); },
        [&](int i) HWY_ATTR { right.extend(i, right_lowest); });
  }
  left.setLowest(left_lowest);
  right.setLowest(right_lowest);
}

/// Both paths at once: whichever comes first to a tile sets its sums.
template <typename Cost>
HWY_INLINE void runRow(const RowJob<Cost>& job, RowBuffer* buffers) {
  const PenaltyLanes penalties(job.setup.penalties);
  RowPath<Cost> left(job, penalties, 1, buffers[0]);
  RowPath<Cost> right(job, penalties, -1, buffers[1]);
  const int tiles = job.setup.space->tiles();
  for (int t = 0; t < tiles; ++t) {
    const int opposite = tiles - 1 - t;
    left.enter(t);
    right.enter(opposite);
    walkTiles(left, right);
    if (t <= opposite) {
      left.template leave<false>();
    } else {
      left.template leave<true>();
    }
    if (t < opposite) {
      right.template leave<false>();
    } else {
      right.template leave<true>();
    }
  }
}

void runRowOfBytes(const RowJob<std::uint8_t>& job, RowBuffer* buffers) { runRow(job, buffers); }
void runRowOfWords(const RowJob<std::uint16_t>& job, RowBuffer* buffers) { runRow(job, buffers); }

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace cbmv
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cbmv {
namespace {

HWY_EXPORT(runRowOfBytes);
HWY_EXPORT(runRowOfWords);

void runRow(const RowJob<std::uint8_t>& job, RowBuffer* buffers) {
  HWY_DYNAMIC_DISPATCH(runRowOfBytes)(job, buffers);
}
void runRow(const RowJob<std::uint16_t>& job, RowBuffer* buffers) {
  HWY_DYNAMIC_DISPATCH(runRowOfWords)(job, buffers);
}

}  // namespace

void RowBuffer::resize(int disparities) {
  // Lanes: gaps are no wider than what they stand for.
  const std::ptrdiff_t lanes = (disparities + kGap - 1) / kGap * kGap;
  stride = lanes + kGap;
  runs.resize((disparities + 1) / 2);
  previous_runs.resize(runs.size());
  run_count = previous_run_count = 0;
  entries.resize((lanes + 2) * kTileColumns);
  pixels.assign(kGap + kTileColumns * stride, kNoPath);
  previous.assign(kGap + disparities + kGap + 2, kNoPath);
  along.resize(lanes + kGap);
  beside.resize(along.size());
}

void RowPaths::resize(const PathSetup& setup) {
  setup_ = &setup;
  for (RowBuffer& buffer : buffers_) {
    buffer.resize(setup.space->range().count);
  }
}

template <typename Cost>
void RowPaths::run(const WindowedVolume<Cost>& costs, int y, WindowedOptimizedVolume& sums) {
  runRow(RowJob<Cost>{*setup_, costs, sums, y}, buffers_.data());
}

template void RowPaths::run(const WindowedMatchingVolume&, int, WindowedOptimizedVolume&);
template void RowPaths::run(const WindowedOptimizedVolume&, int, WindowedOptimizedVolume&);

}  // namespace cbmv
#endif  // HWY_ONCE
