#include "optimization/windowed_sgm_rows.h"

#include <algorithm>
#include <array>
#include <utility>

#include <hwy/cache_control.h>

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

/// Neighbouring rows of pixels, at most kRowsAtOnce.
template <typename Cost>
struct RowJob {
  const PathSetup& setup;
  const WindowedVolume<Cost>& costs;
  WindowedOptimizedVolume& sums;
  cv::Range rows;
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

/// The path costs of some lanes of a pixel, which hold matching costs and edges. `blocked`:
/// kNoHypothesis in lanes without a hypothesis, else 0. `edge`: 1 if the reference image has one,
/// else 0.
HWY_INLINE V extendLanes(const PenaltyLanes& penalties, int edge, V values, V blocked, V along,
                         V beside, V lowest) {
  const Tag tag;
  const auto edge_bit = hn::Set(tag, kEdgeBit);
  const auto edges = hn::TestBit(values, edge_bit);
  const auto p1 = hn::IfThenElse(edges, hn::Load(tag, penalties.p1[edge + 1]),
                                 hn::Load(tag, penalties.p1[edge]));
  const auto p2 = hn::IfThenElse(edges, hn::Load(tag, penalties.p2[edge + 1]),
                                 hn::Load(tag, penalties.p2[edge]));
  const auto matching = hn::Or(hn::AndNot(edge_bit, values), blocked);
  return pathCosts(matching, along, beside, lowest, p1, p2);
}

/// Costs of `count` entries, with the edges of the other image, which start `slope` apart.
template <typename Cost>
HWY_INLINE void packEntries(const Cost* costs, const std::int8_t* edges, std::ptrdiff_t slope,
                            int count, std::uint16_t* out) {
  const ColumnTag tag;
  const hn::RebindToSigned<ColumnTag> signed_tag;
  const hn::Rebind<std::int8_t, ColumnTag> edge_tag;
  const auto edge_bit = hn::Set(tag, kEdgeBit);
  for (int i = 0; i < count; ++i) {
    for (int column = 0; column < kTileColumns; column += static_cast<int>(hn::Lanes(tag))) {
      const auto edge = hn::PromoteTo(signed_tag, hn::LoadU(edge_tag, edges + column));
      const auto cost = loadWidened(tag, costs + column);
      hn::Store(hn::Or(cost, hn::And(hn::BitCast(tag, edge), edge_bit)), tag, out + column);
    }
    costs += kTileColumns;
    edges += slope;
    out += kTileColumns;
  }
}

/// Sets sums, or adds to them.
template <bool kAdd>
HWY_INLINE void sumUp(const std::uint16_t* costs, int count, std::uint16_t* sums) {
  const ColumnTag tag;
  for (int i = 0; i < count; i += static_cast<int>(hn::Lanes(tag))) {
    const auto cost = hn::Load(tag, costs + i);
    hn::Store(kAdd ? hn::Add(hn::Load(tag, sums + i), cost) : cost, tag, sums + i);
  }
}

/// `count` values, rounded up to whole vectors, but at least one.
HWY_INLINE void fillVectors(std::uint16_t value, int count, std::uint16_t* out) {
  const Tag tag;
  const auto step = static_cast<int>(hn::Lanes(tag));
  const auto values = hn::Set(tag, value);
  hn::StoreU(values, tag, out);  // most often the only one: not in the loop, which calls memset
  for (int i = step; i < count; i += step) {
    hn::StoreU(values, tag, out + i);
  }
}

/// Fetches what will be read a tile later.
template <typename Value>
HWY_INLINE void prefetch(const Value* values, std::size_t count) {
  for (std::size_t i = 0; i < count; i += 64 / sizeof(Value)) {
    hwy::Prefetch(values + i);
  }
}

/// A path along a row, in one of both directions.
template <typename Cost>
class RowPath {
 public:
  /// Goes nowhere if `y` is none of the rows.
  RowPath(const RowJob<Cost>& job, int y, const PenaltyLanes& penalties, int direction,
          const RowMemory& memory)
      : job_(job),
        y_(y),
        penalties_(penalties),
        direction_(direction),
        stride_(direction * memory.stride),
        memory_(memory),
        first_pixel_(memory.pixels) {}

  /// Lays out the n-th tile of the path.
  HWY_INLINE void enter(int n) {
    if (y_ >= job_.rows.end) {
      return;
    }
    const SearchSpace& space = *job_.setup.space;
    const int t = direction_ > 0 ? n : space.tiles() - 1 - n;
    tile_ = space.tile(y_, t);
    columns_ = tile_.count == 0 ? 0 : std::min(kTileColumns, space.width() - t * kTileColumns);
    if (columns_ == 0) {
      return;
    }
    const int first_column = direction_ > 0 ? 0 : columns_ - 1;
    const PathSteps steps =
        job_.setup.steps.row(y_).from(t * kTileColumns + (direction_ > 0 ? 0 : 1));
    first_pixel_ = memory_.pixels + first_column * memory_.stride;
    first_edge_ = steps.reference_edges + first_column;
    first_rise_ = steps.rises + first_column;
    prefetchTile(t + direction_);
    prefetch(job_.sums.entry(tile_.first_entry), tile_.count * kTileColumns);
    findRuns();
    block();
    fillPixels(steps);
  }

  /// Extends the path by the first pixel of the tile.
  HWY_INLINE void start() {
    if (columns_ > 0) {
      takePrevious(rise(0));
      extendFirst();
    }
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
  HWY_INLINE V blockedLanes() const { return hn::Load(Tag(), memory_.blocked); }

  /// Extends the path by the i-th pixel of a tile that fits one vector.
  HWY_INLINE void extendVector(int i, V blocked, V& costs, V& lowest) {
    const Tag tag;
    const int rising = rise(i);
    if (HWY_UNLIKELY(rising != 0)) {
      costs = rising > 0 ? rotateUp(tag, costs) : rotateDown(tag, costs);
    }
    const auto beside = hn::Min(rotateUp(tag, costs), rotateDown(tag, costs));
    costs = extendLanes(penalties_, edge(i), hn::Load(tag, pixel(i)), blocked, costs, beside,
                        lowest);
    hn::Store(costs, tag, pixel(i));
    lowest = lowestOfLanes(tag, costs);
  }

  /// The same for any tile.
  HWY_INLINE void extend(int i, V& lowest) {
    const Tag tag;
    const auto step = static_cast<int>(hn::Lanes(tag));
    const std::uint16_t* previous = pixel(i - 1) - rise(i);
    std::uint16_t* current = pixel(i);
    const std::uint16_t* blocked = memory_.blocked;
    const int lanes = lanes_;
    const int reference_edge = edge(i);
    auto lowest_cost = hn::Set(tag, kNoPath);
    for (int lane = 0; lane < lanes; lane += step) {
      const auto beside =
          hn::Min(hn::LoadU(tag, previous + lane - 1), hn::LoadU(tag, previous + lane + 1));
      const auto costs = extendLanes(penalties_, reference_edge, hn::Load(tag, current + lane),
                                     hn::Load(tag, blocked + lane),
                                     hn::LoadU(tag, previous + lane), beside, lowest);
      lowest_cost = hn::Min(lowest_cost, costs);
      hn::Store(costs, tag, current + lane);
    }
    lowest = lowestOfLanes(tag, lowest_cost);
  }

  /// Sets the sums of the n-th tile of the path, or adds the path costs to them.
  HWY_INLINE void leave(int n) {
    fresh_ = columns_ == 0;
    if (!fresh_) {
      keepLast();
      const int other = job_.setup.space->tiles() - 1 - n;
      if (n < other || (n == other && direction_ > 0)) {
        addToSums<false>();
      } else {
        addToSums<true>();
      }
    }
  }

  /// Leaves the memory as it was found.
  HWY_INLINE void finish() { forget(memory_.runs); }

 private:
  template <bool kAdd>
  HWY_INLINE void addToSums() {
    pixelsToLanes(memory_.pixels, paddedLanes(), memory_.stride, memory_.entries);
    std::uint16_t* sums = job_.sums.entry(tile_.first_entry);
    for (const LaneRun* run = memory_.runs; run->length > 0; ++run) {
      sumUp<kAdd>(memory_.entries + run->lane * kTileColumns, run->length * kTileColumns, sums);
      sums += run->length * kTileColumns;
    }
  }

  std::uint16_t* pixel(int i) const { return first_pixel_ + i * stride_; }
  int edge(int i) const { return -first_edge_[i * direction_]; }
  int rise(int i) const { return direction_ * first_rise_[i * direction_]; }
  int paddedLanes() const {
    return (lanes_ + kTransposeLanes - 1) / kTransposeLanes * kTransposeLanes;
  }

  HWY_INLINE void prefetchTile(int t) {
    if (t >= 0 && t < job_.setup.space->tiles()) {
      const auto tile = job_.setup.space->tile(y_, t);
      prefetch(job_.costs.entry(tile.first_entry), tile.count * kTileColumns);
    }
  }

  /// Runs are two lanes apart, or one if a single disparity lies between them: a path goes on at
  /// most two disparities away.
  HWY_INLINE void findRuns() {
    std::swap(memory_.runs, memory_.previous_runs);
    LaneRun* run = memory_.runs;
    const std::int16_t* indices = tile_.indices;
    const int count = tile_.count;
    int first = 0;
    int lane = 0;
    while (true) {
      int end = count;
      if (indices[count - 1] - indices[first] >= count - first) {
        for (end = first + 1; indices[end] == indices[end - 1] + 1; ++end) {
        }
      }
      *run++ = {lane, indices[first], end - first};
      lane += end - first;
      if (end == count) {
        break;
      }
      lane += std::min(indices[end] - indices[end - 1] - 1, 2);
      first = end;
    }
    *run = {lane, 0, 0};
    lanes_ = lane;
  }

  /// Marks the lanes that have no hypothesis, as far as a vector reaches.
  HWY_INLINE void block() {
    for (const LaneRun* run = memory_.runs; run->length > 0; ++run) {
      fillVectors(0, run->length, memory_.blocked + run->lane);
      fillVectors(kNoHypothesis, 1, memory_.blocked + run->lane + run->length);
    }
  }

  HWY_INLINE void fillPixels(const PathSteps& steps) {
    const Cost* costs = job_.costs.entry(tile_.first_entry);
    for (const LaneRun* run = memory_.runs; run->length > 0; ++run) {
      packEntries(costs, steps.other_edges + steps.slope * run->index, steps.slope, run->length,
                  memory_.entries + run->lane * kTileColumns);
      costs += run->length * kTileColumns;
    }
    lanesToPixels(memory_.entries, paddedLanes(), memory_.stride, memory_.pixels);
    if (!fitsOneVector()) {
      const auto step = static_cast<int>(hn::Lanes(Tag()));
      const int end = (lanes_ + step - 1) / step * step;
      for (int column = 0; column < kTileColumns; ++column) {
        fillVectors(kNoPath, 1, memory_.pixels + column * memory_.stride + end);
      }
    }
  }

  /// The costs of the last pixel, by disparity, for the next tile.
  HWY_INLINE void keepLast() {
    const Tag tag;
    const auto step = static_cast<int>(hn::Lanes(tag));
    const std::uint16_t* last = pixel(columns_ - 1);
    for (const LaneRun* run = memory_.runs; run->length > 0; ++run) {
      std::uint16_t* out = memory_.previous + run->index;
      for (int i = 0; i < run->length; i += step) {
        hn::BlendedStore(hn::LoadU(tag, last + run->lane + i), hn::FirstN(tag, run->length - i),
                         tag, out + i);
      }
    }
  }

  /// Along and beside of the new tile's lanes, from the costs kept by disparity, which are
  /// forgotten. Stores reach beyond the runs: later runs overwrite them, and of lanes without a
  /// hypothesis nothing matters.
  HWY_INLINE void takePrevious(int rising) {
    const Tag tag;
    const auto step = static_cast<int>(hn::Lanes(tag));
    if (fresh_) {
      // All costs zero, from which the step leads to L = C.
      lowest_ = 0;
      fillVectors(0, lanes_, memory_.along);
    } else {
      for (const LaneRun* run = memory_.runs; run->length > 0; ++run) {
        const std::uint16_t* in = memory_.previous + run->index - rising;
        for (int i = 0; i < run->length; i += step) {
          hn::StoreU(hn::LoadU(tag, in + i), tag, memory_.along + run->lane + i);
          hn::StoreU(hn::Min(hn::LoadU(tag, in + i - 1), hn::LoadU(tag, in + i + 1)), tag,
                     memory_.beside + run->lane + i);
        }
      }
    }
    forget(memory_.previous_runs);
  }

  HWY_INLINE void forget(const LaneRun* run) {
    for (; run->length > 0; ++run) {
      fillVectors(kNoPath, run->length, memory_.previous + run->index);
    }
  }

  HWY_INLINE void extendFirst() {
    const Tag tag;
    const auto step = static_cast<int>(hn::Lanes(tag));
    const auto lowest_previous = lowest();
    auto lowest_cost = hn::Set(tag, kNoPath);
    for (int lane = 0; lane < lanes_; lane += step) {
      const auto costs = extendLanes(
          penalties_, edge(0), hn::Load(tag, pixel(0) + lane),
          hn::Load(tag, memory_.blocked + lane), hn::Load(tag, memory_.along + lane),
          hn::Load(tag, memory_.beside + lane), lowest_previous);
      lowest_cost = hn::Min(lowest_cost, costs);
      hn::Store(costs, tag, pixel(0) + lane);
    }
    setLowest(lowestOfLanes(tag, lowest_cost));
  }

  const RowJob<Cost>& job_;
  const int y_;
  const PenaltyLanes& penalties_;
  const int direction_;  ///< 1: from the left, -1: from the right
  const std::ptrdiff_t stride_;
  RowMemory memory_;
  bool fresh_ = true;  ///< the next pixel is the first one of the path
  std::uint16_t lowest_ = 0;
  SearchSpace::Tile tile_{nullptr, 0, 0};
  int columns_ = 0;
  int lanes_ = 0;
  std::uint16_t* first_pixel_;
  const std::int8_t* first_edge_ = nullptr;
  const std::int8_t* first_rise_ = nullptr;
};

/// Calls a(i) … d(i) in turns, since each waits for its result of the call before, for the second
/// and later pixels of the tiles.
template <typename A, typename B, typename C, typename D>
HWY_INLINE void inTurns(const std::array<int, 4>& columns, const A& a, const B& b, const C& c,
                        const D& d) {
  const int all = *std::min_element(columns.begin(), columns.end());
  for (int i = 1; i < all; ++i) {
    a(i);
    b(i);
    c(i);
    d(i);
  }
  const auto finish = [&](const auto& path, int end) HWY_ATTR {
    for (int i = std::max(all, 1); i < end; ++i) {
      path(i);
    }
  };
  finish(a, columns[0]);
  finish(b, columns[1]);
  finish(c, columns[2]);
  finish(d, columns[3]);
}

template <typename Cost>
HWY_INLINE void walkTiles(RowPath<Cost>& a, RowPath<Cost>& b, RowPath<Cost>& c, RowPath<Cost>& d) {
  const std::array<int, 4> columns = {a.columns(), b.columns(), c.columns(), d.columns()};
  auto lowest_a = a.lowest();
  auto lowest_b = b.lowest();
  auto lowest_c = c.lowest();
  auto lowest_d = d.lowest();
#if !HWY_HAVE_SCALABLE
  if (a.fitsOneVector() && b.fitsOneVector() && c.fitsOneVector() && d.fitsOneVector()) {
    const auto blocked_a = a.blockedLanes();
    const auto blocked_b = b.blockedLanes();
    const auto blocked_c = c.blockedLanes();
    const auto blocked_d = d.blockedLanes();
    auto costs_a = a.firstCosts();
    auto costs_b = b.firstCosts();
    auto costs_c = c.firstCosts();
    auto costs_d = d.firstCosts();
    inTurns(
        columns, [&](int i) HWY_ATTR { a.extendVector(i, blocked_a, costs_a, lowest_a); },
        [&](int i) HWY_ATTR { b.extendVector(i, blocked_b, costs_b, lowest_b); },
        [&](int i) HWY_ATTR { c.extendVector(i, blocked_c, costs_c, lowest_c); },
        [&](int i) HWY_ATTR { d.extendVector(i, blocked_d, costs_d, lowest_d); });
  } else
#endif
  {
    inTurns(
        columns, [&](int i) HWY_ATTR { a.extend(i, lowest_a); },
        [&](int i) HWY_ATTR { b.extend(i, lowest_b); },
        [&](int i) HWY_ATTR { c.extend(i, lowest_c); },
        [&](int i) HWY_ATTR { d.extend(i, lowest_d); });
  }
  a.setLowest(lowest_a);
  b.setLowest(lowest_b);
  c.setLowest(lowest_c);
  d.setLowest(lowest_d);
}

/// Both paths of the rows at once: whichever comes first to a tile sets its sums.
template <typename Cost>
HWY_INLINE void runRows(const RowJob<Cost>& job, RowBuffer* buffers) {
  const PenaltyLanes penalties(job.setup.penalties);
  const int y = job.rows.start;
  RowPath<Cost> paths[] = {{job, y, penalties, 1, buffers[0].memory()},
                           {job, y, penalties, -1, buffers[1].memory()},
                           {job, y + 1, penalties, 1, buffers[2].memory()},
                           {job, y + 1, penalties, -1, buffers[3].memory()}};
  const int tiles = job.setup.space->tiles();
  for (int n = 0; n < tiles; ++n) {
    for (RowPath<Cost>& path : paths) {
      path.enter(n);
    }
    for (RowPath<Cost>& path : paths) {
      path.start();
    }
    walkTiles(paths[0], paths[1], paths[2], paths[3]);
    for (RowPath<Cost>& path : paths) {
      path.leave(n);
    }
  }
  for (RowPath<Cost>& path : paths) {
    path.finish();
  }
}

void runRowsOfBytes(const RowJob<std::uint8_t>& job, RowBuffer* buffers) { runRows(job, buffers); }
void runRowsOfWords(const RowJob<std::uint16_t>& job, RowBuffer* buffers) { runRows(job, buffers); }

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace cbmv
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cbmv {
namespace {

HWY_EXPORT(runRowsOfBytes);
HWY_EXPORT(runRowsOfWords);

void runRows(const RowJob<std::uint8_t>& job, RowBuffer* buffers) {
  HWY_DYNAMIC_DISPATCH(runRowsOfBytes)(job, buffers);
}
void runRows(const RowJob<std::uint16_t>& job, RowBuffer* buffers) {
  HWY_DYNAMIC_DISPATCH(runRowsOfWords)(job, buffers);
}

}  // namespace

void RowBuffer::resize(int disparities) {
  // Lanes: gaps are no wider than what they stand for.
  const std::ptrdiff_t lanes = (disparities + kGap - 1) / kGap * kGap;
  stride_ = lanes + kGap;
  runs_.assign(2 * maxRuns(disparities), LaneRun{0, 0, 0});
  entries_.resize(lanes * kTileColumns);
  pixels_.assign(kGap + kTileColumns * stride_, kNoPath);
  blocked_.resize(lanes + kGap);
  previous_.assign(kGap + disparities + kGap + 2, kNoPath);
  along_.resize(lanes + kGap);
  beside_.resize(along_.size());
}

RowMemory RowBuffer::memory() {
  return {runs_.data(),        runs_.data() + runs_.size() / 2,
          entries_.data(),     pixels_.data() + kGap,
          stride_,             blocked_.data(),
          previous_.data() + kGap, along_.data(),
          beside_.data()};
}

void RowPaths::resize(const PathSetup& setup) {
  setup_ = &setup;
  for (RowBuffer& buffer : buffers_) {
    buffer.resize(setup.space->range().count);
  }
}

template <typename Cost>
void RowPaths::run(const WindowedVolume<Cost>& costs, const cv::Range& rows,
                   WindowedOptimizedVolume& sums) {
  runRows(RowJob<Cost>{*setup_, costs, sums, rows}, buffers_.data());
}

template void RowPaths::run(const WindowedMatchingVolume&, const cv::Range&,
                            WindowedOptimizedVolume&);
template void RowPaths::run(const WindowedOptimizedVolume&, const cv::Range&,
                            WindowedOptimizedVolume&);

}  // namespace cbmv
#endif  // HWY_ONCE
