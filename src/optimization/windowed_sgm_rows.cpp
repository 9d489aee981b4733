#include "optimization/windowed_sgm_rows.h"

#include <algorithm>
#include <array>

#include "base/round_up.h"
#include "matching/row_entries.h"

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

/// Neighboring rows of pixels, at most RowPaths::kRowsAtOnce.
template <typename Cost>
struct RowJob {
  const PathSetup& setup;
  const WindowedVolume<Cost>& costs;
  WindowedAggregatedVolume& sums;
  cv::Range rows;
};

/// A lane of matching costs has a cost and two edge bits. The bits are set if the other image has
/// an edge at the step from the left or from the right neighbor.
constexpr std::uint16_t kLeftEdge = 0x4000;
constexpr std::uint16_t kRightEdge = 0x8000;
constexpr std::uint16_t kCostBits = 0x3FFF;
static_assert(kMaxPathCost <= kCostBits);
/// Matching cost in a lane without a hypothesis. It is above every path cost, and a penalty can be
/// added without overflow.
constexpr std::uint16_t kNoHypothesis = 0xBFFF;
static_assert(kNoHypothesis > 2 * kMaxPathCost && kNoHypothesis + kMaxPathCost <= kNoPath);

}  // namespace
}  // namespace cbmv
#endif

HWY_BEFORE_NAMESPACE();
namespace cbmv {
namespace HWY_NAMESPACE {
namespace {

using Tag = LineTag<std::uint16_t>;
using V = hn::Vec<Tag>;

/// Stores `count` values, rounded up to whole vectors, at least one vector.
HWY_INLINE void fillVectors(std::uint16_t value, int count, std::uint16_t* out) {
  const Tag tag;
  const auto step = static_cast<int>(hn::Lanes(tag));
  const auto values = hn::Set(tag, value);
  // Usually one vector is enough. It is outside of the loop because compilers replace the loop by
  // memset.
  hn::StoreU(values, tag, out);
  for (int i = step; i < count; i += step) {
    hn::StoreU(values, tag, out + i);
  }
}

/// Assigns the list of a tile to lanes. Runs are two lanes apart, or one lane if a single disparity
/// is missing between them, because a path changes by at most two disparities. Returns the end of
/// the runs.
HWY_INLINE LaneRun* findRuns(const SearchSpace::Tile& tile, LaneRun* run) {
  const std::int16_t* indices = tile.indices;
  int lane = 0;
  for (int first = 0; first < tile.count;) {
    int end = tile.count;
    if (indices[end - 1] - indices[first] >= end - first) {
      for (end = first + 1; indices[end] == indices[end - 1] + 1; ++end) {
      }
    }
    if (first > 0) {
      lane += std::min(indices[first] - indices[first - 1] - 1, 2);
    }
    *run++ = {lane, indices[first], end - first};
    lane += end - first;
    first = end;
  }
  *run++ = {lane, 0, 0};
  return run;
}

/// Distance between the pixels of a tile: whole vectors with room for the transposition of all
/// runs.
HWY_INLINE int strideOf(const LaneRun* run) {
  int lanes = 0;
  for (; run->length > 0; ++run) {
    lanes = std::max(lanes, run->lane + roundUp(run->length, kTransposeLanes));
  }
  return roundUp(lanes, static_cast<int>(hn::Lanes(Tag())));
}

/// Marks the lanes without a hypothesis, up to whole vectors.
HWY_INLINE void block(const LaneRun* run, std::uint16_t* blocked) {
  for (; run->length > 0; ++run) {
    fillVectors(0, run->length, blocked + run->lane);
    fillVectors(kNoHypothesis, 1, blocked + run->lane + run->length);
  }
}

/// Matching costs of an entry with the edge bits of the other image.
template <typename Cost>
HWY_INLINE hn::Vec<TransposeTag> packed(const Cost* costs, const std::int8_t* edges) {
  const TransposeTag tag;
  const hn::RebindToSigned<TransposeTag> signed_tag;
  const hn::Rebind<std::int8_t, TransposeTag> edge_tag;
  const auto left = hn::PromoteTo(signed_tag, hn::LoadU(edge_tag, edges));
  const auto right = hn::PromoteTo(signed_tag, hn::LoadU(edge_tag, edges + 1));
  const auto bits = hn::Or(hn::And(hn::BitCast(tag, left), hn::Set(tag, kLeftEdge)),
                           hn::And(hn::BitCast(tag, right), hn::Set(tag, kRightEdge)));
  return hn::Or(loadWidened(tag, costs), bits);
}

/// Copies a row to the layout by lanes.
template <typename Cost>
HWY_INLINE void layOut(const RowJob<Cost>& job, int y, LaneRow& row) {
  const SearchSpace& space = *job.setup.space;
  const PathSteps steps = job.setup.steps.row(y);
  const std::ptrdiff_t slope = steps.slope;
  LaneRun* runs = row.runs.data();
  std::uint16_t* matching = row.matching.data();
  std::uint16_t* path_costs = row.costs.data();
  const Cost* costs = job.costs.entry(space.tile(y, 0).first_entry);
  for (int t = 0; t < space.tiles(); ++t) {
    LaneRun* end = findRuns(space.tile(y, t), runs);
    const int stride = strideOf(runs);
    const int lanes = end[-1].lane;
    row.tiles[t] = {runs,   lanes,    roundUp(lanes, static_cast<int>(hn::Lanes(Tag()))),
                    stride, matching, path_costs};
    block(runs, matching + kTileColumns * stride);
    for (; runs->length > 0; ++runs) {
      const std::int8_t* edges = steps.other_edges + t * kTileColumns + slope * runs->index;
      lanesToPixels(runs->length, stride, matching + runs->lane, [&](int i, int column) HWY_ATTR {
        return packed(costs + i * kTileColumns + column, edges + slope * i + column);
      });
      costs += runs->length * kTileColumns;
    }
    runs = end;
    matching += (kTileColumns + 1) * stride;
    path_costs += kTileColumns * stride;
  }
}

/// Stores the sums of the path costs of a row.
template <typename Cost>
HWY_INLINE void storeSums(const RowJob<Cost>& job, int y, const LaneRow& row) {
  std::uint16_t* sums = job.sums.entry(job.setup.space->tile(y, 0).first_entry);
  for (const LaneTile& tile : row.tiles) {
    for (const LaneRun* run = tile.runs; run->length > 0; ++run) {
      pixelsToLanes(tile.costs + run->lane, tile.stride, run->length, sums);
      sums += run->length * kTileColumns;
    }
  }
}

/// Penalties in all lanes, by the number of images with an edge: P1, then P2.
struct PenaltyLanes {
  static constexpr int kCounts = 3;
  alignas(64) std::uint16_t lanes[2 * kCounts * kMostLanes];

  explicit PenaltyLanes(const SgmPenalties& penalties) {
    for (int edges = 0; edges < kCounts; ++edges) {
      std::fill_n(lanes + edges * kMostLanes, kMostLanes,
                  static_cast<std::uint16_t>(penalties.p1[edges]));
      std::fill_n(lanes + (kCounts + edges) * kMostLanes, kMostLanes,
                  static_cast<std::uint16_t>(penalties.p2[edges]));
    }
  }
};

/// A path along a row in one direction.
class RowPath {
 public:
  /// `direction` is 1 for the path from the left and -1 for the path from the right.
  RowPath(const LaneRow& row, const PathSteps& steps, int width, const PenaltyLanes& penalties,
          int direction, RowFront& front)
      : row_(row),
        steps_(steps.from(direction > 0 ? 0 : 1)),
        width_(width),
        penalties_(penalties),
        direction_(direction),
        edge_bit_(direction > 0 ? kLeftEdge : kRightEdge),
        front_(front) {}

  /// Extends the path by the first pixel of tile t, if the tile has hypotheses.
  template <bool kAdd>
  HWY_INLINE void start(int t) {
    tile_ = row_.tiles[t];
    columns_ = tile_.lanes == 0 ? 0 : std::min(kTileColumns, width_ - t * kTileColumns);
    if (columns_ == 0) {
      fresh_ = true;
      return;
    }
    const int column = direction_ > 0 ? 0 : columns_ - 1;
    stride_ = direction_ * tile_.stride;
    matching_ = tile_.matching + column * tile_.stride;
    costs_ = tile_.costs + column * tile_.stride;
    blocked_ = tile_.matching + kTileColumns * tile_.stride;
    edges_ = steps_.reference_edges + t * kTileColumns + column;
    rises_ = steps_.rises + t * kTileColumns + column;
    fillVectors(kNoPath, 1, front_.costs(0) + tile_.padded_lanes);
    fillVectors(kNoPath, 1, front_.costs(1) + tile_.padded_lanes);
    takePrevious(rise(0));
    extendFirst<kAdd>();
    fresh_ = false;
  }

  int columns() const { return columns_; }
  /// Number of lanes that a vector needs for the tile. Rotations by two must bring in lanes without
  /// a hypothesis.
  int fittingLanes() const { return tile_.lanes + 2; }

  template <class D>
  HWY_INLINE hn::Vec<D> lowest(D tag) const {
    return hn::Set(tag, lowest_);
  }
  template <class Lanes>
  HWY_INLINE void setLowest(Lanes lowest) {
    lowest_ = hn::GetLane(lowest);
  }
  template <class D>
  HWY_INLINE hn::Vec<D> blocked(D tag) const {
    return hn::Load(tag, blocked_);
  }
  template <class D>
  HWY_INLINE hn::Vec<D> costs(D tag, int i) const {
    return hn::Load(tag, front_.costs(i));
  }
  template <class D>
  HWY_INLINE void setCosts(D tag, int i, hn::Vec<D> costs) {
    hn::Store(costs, tag, front_.costs(i));
  }

#if !HWY_HAVE_SCALABLE
  /// Extends the path by the i-th pixel of a tile that fits one vector.
  template <bool kAdd, class D, class Lanes = hn::Vec<D>>
  HWY_INLINE void extendVector(D tag, int i, Lanes blocked, Lanes& costs, Lanes& lowest) {
    const int rising = rise(i);
    if (HWY_UNLIKELY(rising != 0)) {
      costs = rising > 0 ? rotateUp(tag, costs) : rotateDown(tag, costs);
    }
    const auto beside = hn::Min(rotateUp(tag, costs), rotateDown(tag, costs));
    costs = extendLanes<kAdd>(tag, i, 0, penalties(i), blocked, costs, beside, lowest);
    lowest = lowestOfLanes(tag, costs);
  }
#endif

  /// Extends the path by the i-th pixel of any tile.
  template <bool kAdd>
  HWY_INLINE void extend(int i, V& lowest) {
    const Tag tag;
    const auto step = static_cast<int>(hn::Lanes(tag));
    const std::uint16_t* previous = front_.costs(i - 1) - rise(i);
    std::uint16_t* current = front_.costs(i);
    const std::uint16_t* penalties_here = penalties(i);
    auto lowest_cost = hn::Set(tag, kNoPath);
    for (int lane = 0; lane < tile_.padded_lanes; lane += step) {
      const auto beside =
          hn::Min(hn::LoadU(tag, previous + lane - 1), hn::LoadU(tag, previous + lane + 1));
      const auto costs =
          extendLanes<kAdd>(tag, i, lane, penalties_here, hn::Load(tag, blocked_ + lane),
                            hn::LoadU(tag, previous + lane), beside, lowest);
      lowest_cost = hn::Min(lowest_cost, costs);
      hn::Store(costs, tag, current + lane);
    }
    lowest = lowestOfLanes(tag, lowest_cost);
  }

  /// Keeps the costs of the last pixel for the next tile.
  HWY_INLINE void leave() {
    if (columns_ == 0) {
      return;
    }
    // Runs are short, and the memory may have been written by narrow stores just before.
    const hn::CappedTag<std::uint16_t, 8> tag;
    const auto step = static_cast<int>(hn::Lanes(tag));
    const std::uint16_t* last = front_.costs(columns_ - 1);
    for (const LaneRun* run = tile_.runs; run->length > 0; ++run) {
      std::uint16_t* out = front_.previous() + run->index;
      for (int i = 0; i < run->length; i += step) {
        hn::BlendedStore(hn::LoadU(tag, last + run->lane + i), hn::FirstN(tag, run->length - i),
                         tag, out + i);
      }
    }
    kept_ = tile_.runs;
  }

  /// Clears the kept costs.
  HWY_INLINE void forget() {
    for (; kept_->length > 0; ++kept_) {
      fillVectors(kNoPath, kept_->length, front_.previous() + kept_->index);
    }
  }

 private:
  int rise(int i) const { return direction_ * rises_[i * direction_]; }
  /// Penalties at the i-th pixel without an edge in the other image.
  const std::uint16_t* penalties(int i) const {
    return penalties_.lanes - static_cast<std::ptrdiff_t>(edges_[i * direction_]) * kMostLanes;
  }

  /// Computes the path costs of some lanes of the i-th pixel. Sets the sums, or adds with kAdd.
  template <bool kAdd, class D, class Lanes = hn::Vec<D>>
  HWY_INLINE Lanes extendLanes(D tag, int i, int lane, const std::uint16_t* penalties,
                               Lanes blocked, Lanes along, Lanes beside, Lanes lowest) {
    const auto values = hn::Load(tag, matching_ + i * stride_ + lane);
    const auto edges = hn::TestBit(values, hn::Set(tag, edge_bit_));
    const auto penalty = [&](int first) HWY_ATTR {  // a lambda, because a vector cannot be a member
      return hn::IfThenElse(edges, hn::Load(tag, penalties + (first + 1) * kMostLanes),
                            hn::Load(tag, penalties + first * kMostLanes));
    };
    const auto p1 = penalty(0);
    const auto p2 = penalty(PenaltyLanes::kCounts);
    const auto matching = hn::Or(hn::And(values, hn::Set(tag, kCostBits)), blocked);
    const auto costs = pathCosts(matching, along, beside, lowest, p1, p2);
    std::uint16_t* sums = costs_ + i * stride_ + lane;
    hn::Store(kAdd ? hn::Add(hn::Load(tag, sums), costs) : costs, tag, sums);
    return costs;
  }

  /// Sets `along` and `beside` for the lanes of the new tile from the kept costs, and clears these.
  /// Stores extend beyond the runs. Later runs overwrite them, and values in lanes without a
  /// hypothesis do not matter.
  HWY_INLINE void takePrevious(int rising) {
    const Tag tag;
    const auto step = static_cast<int>(hn::Lanes(tag));
    if (fresh_) {
      // With all costs zero, the step gives L = C.
      lowest_ = 0;
      fillVectors(0, tile_.lanes, front_.along());
    } else {
      for (const LaneRun* run = tile_.runs; run->length > 0; ++run) {
        const std::uint16_t* in = front_.previous() + run->index - rising;
        for (int i = 0; i < run->length; i += step) {
          hn::StoreU(hn::LoadU(tag, in + i), tag, front_.along() + run->lane + i);
          hn::StoreU(hn::Min(hn::LoadU(tag, in + i - 1), hn::LoadU(tag, in + i + 1)), tag,
                     front_.beside() + run->lane + i);
        }
      }
    }
    forget();
  }

  template <bool kAdd>
  HWY_INLINE void extendFirst() {
    const Tag tag;
    const auto step = static_cast<int>(hn::Lanes(tag));
    const auto lowest_previous = lowest(tag);
    auto lowest_cost = hn::Set(tag, kNoPath);
    for (int lane = 0; lane < tile_.padded_lanes; lane += step) {
      const auto costs =
          extendLanes<kAdd>(tag, 0, lane, penalties(0), hn::Load(tag, blocked_ + lane),
                            hn::Load(tag, front_.along() + lane),
                            hn::Load(tag, front_.beside() + lane), lowest_previous);
      lowest_cost = hn::Min(lowest_cost, costs);
      hn::Store(costs, tag, front_.costs(0) + lane);
    }
    setLowest(lowestOfLanes(tag, lowest_cost));
  }

  static constexpr LaneRun kNoRun = {0, 0, 0};

  const LaneRow& row_;
  const PathSteps steps_;
  const int width_;
  const PenaltyLanes& penalties_;
  const int direction_;
  const std::uint16_t edge_bit_;
  RowFront& front_;
  const LaneRun* kept_ = &kNoRun;
  bool fresh_ = true;  ///< the next pixel is the first pixel of the path
  std::uint16_t lowest_ = 0;
  // Data of the tile, at its first pixel.
  LaneTile tile_{nullptr, 0, 0, 0, nullptr, nullptr};
  int columns_ = 0;
  std::ptrdiff_t stride_ = 0;
  const std::uint16_t* matching_ = nullptr;
  const std::uint16_t* blocked_ = nullptr;
  std::uint16_t* costs_ = nullptr;
  const std::int8_t* edges_ = nullptr;
  const std::int8_t* rises_ = nullptr;
};

/// Calls a(i) … d(i) in turn for all pixels of the tiles except the first. Interleaving hides
/// latency, because each call needs the result of its previous call.
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

#if !HWY_HAVE_SCALABLE
/// Processes all pixels except the first of tiles that fit one vector.
template <bool kAdd, class D>
HWY_INLINE void walkVectors(D tag, const std::array<int, 4>& columns, RowPath& a, RowPath& b,
                            RowPath& c, RowPath& d) {
  auto lowest_a = a.lowest(tag);
  auto lowest_b = b.lowest(tag);
  auto lowest_c = c.lowest(tag);
  auto lowest_d = d.lowest(tag);
  const auto blocked_a = a.blocked(tag);
  const auto blocked_b = b.blocked(tag);
  const auto blocked_c = c.blocked(tag);
  const auto blocked_d = d.blocked(tag);
  auto costs_a = a.costs(tag, 0);
  auto costs_b = b.costs(tag, 0);
  auto costs_c = c.costs(tag, 0);
  auto costs_d = d.costs(tag, 0);
  inTurns(
      columns, [&](int i) HWY_ATTR { a.extendVector<kAdd>(tag, i, blocked_a, costs_a, lowest_a); },
      [&](int i) HWY_ATTR { b.extendVector<kAdd>(tag, i, blocked_b, costs_b, lowest_b); },
      [&](int i) HWY_ATTR { c.extendVector<kAdd>(tag, i, blocked_c, costs_c, lowest_c); },
      [&](int i) HWY_ATTR { d.extendVector<kAdd>(tag, i, blocked_d, costs_d, lowest_d); });
  a.setCosts(tag, columns[0] - 1, costs_a);
  b.setCosts(tag, columns[1] - 1, costs_b);
  c.setCosts(tag, columns[2] - 1, costs_c);
  d.setCosts(tag, columns[3] - 1, costs_d);
  a.setLowest(lowest_a);
  b.setLowest(lowest_b);
  c.setLowest(lowest_c);
  d.setLowest(lowest_d);
}
#endif

/// The same for tiles of any size.
template <bool kAdd>
HWY_INLINE void walkLongTiles(const std::array<int, 4>& columns, RowPath& a, RowPath& b, RowPath& c,
                              RowPath& d) {
  auto lowest_a = a.lowest(Tag());
  auto lowest_b = b.lowest(Tag());
  auto lowest_c = c.lowest(Tag());
  auto lowest_d = d.lowest(Tag());
  inTurns(
      columns, [&](int i) HWY_ATTR { a.extend<kAdd>(i, lowest_a); },
      [&](int i) HWY_ATTR { b.extend<kAdd>(i, lowest_b); },
      [&](int i) HWY_ATTR { c.extend<kAdd>(i, lowest_c); },
      [&](int i) HWY_ATTR { d.extend<kAdd>(i, lowest_d); });
  a.setLowest(lowest_a);
  b.setLowest(lowest_b);
  c.setLowest(lowest_c);
  d.setLowest(lowest_d);
}

/// Uses the shortest vector that fits. Short vectors are not faster, but their lowest lane is found
/// in fewer steps.
template <bool kAdd>
HWY_INLINE void walkTiles(RowPath& a, RowPath& b, RowPath& c, RowPath& d) {
  const std::array<int, 4> columns = {a.columns(), b.columns(), c.columns(), d.columns()};
#if !HWY_HAVE_SCALABLE
  const bool have_costs = *std::min_element(columns.begin(), columns.end()) > 0;
  const int lanes = have_costs ? std::max(std::max(a.fittingLanes(), b.fittingLanes()),
                                          std::max(c.fittingLanes(), d.fittingLanes()))
                               : kMostLanes + 1;
  if (lanes <= 8) {
    return walkVectors<kAdd>(hn::CappedTag<std::uint16_t, 8>(), columns, a, b, c, d);
  }
  if (lanes <= 16 && hn::Lanes(Tag()) >= 16) {
    return walkVectors<kAdd>(hn::CappedTag<std::uint16_t, 16>(), columns, a, b, c, d);
  }
  if (lanes <= static_cast<int>(hn::Lanes(Tag()))) {
    return walkVectors<kAdd>(Tag(), columns, a, b, c, d);
  }
#endif
  walkLongTiles<kAdd>(columns, a, b, c, d);
}

/// The paths of two rows, each from the left and from the right.
using Paths = std::array<RowPath, 4>;

/// Processes the n-th tiles of all paths.
template <bool kAdd>
HWY_INLINE void walk(int n, int tiles, Paths& paths) {
  paths[0].start<kAdd>(n);
  paths[1].start<kAdd>(tiles - 1 - n);
  paths[2].start<kAdd>(n);
  paths[3].start<kAdd>(tiles - 1 - n);
  walkTiles<kAdd>(paths[0], paths[1], paths[2], paths[3]);
  for (RowPath& path : paths) {
    path.leave();
  }
}

/// The path that reaches a tile first sets its path costs, the other path adds to them.
HWY_INLINE void walkRows(int tiles, const std::array<LaneRow, 2>& rows, Paths& paths) {
  int n = 0;
  for (; n < tiles / 2; ++n) {
    walk<false>(n, tiles, paths);
  }
  if (tiles % 2 == 1) {
    for (const LaneRow& row : rows) {  // both paths meet in this tile
      const LaneTile& tile = row.tiles[n];
      std::fill_n(tile.costs, tile.stride * kTileColumns, std::uint16_t{0});
    }
  }
  for (; n < tiles; ++n) {
    walk<true>(n, tiles, paths);
  }
  for (RowPath& path : paths) {
    path.forget();
  }
}

template <typename Cost>
HWY_INLINE void runRows(const RowJob<Cost>& job, RowPaths::Memory& memory) {
  const SearchSpace& space = *job.setup.space;
  // The second row may be a repetition of the first. Then its sums are not used.
  const std::array<int, 2> y = {job.rows.start, job.rows.end - 1};
  for (std::size_t i = 0; i < 2; ++i) {
    layOut(job, y[i], memory.rows[i]);
  }
  const PenaltyLanes penalties(job.setup.penalties);
  const auto path = [&](std::size_t i) HWY_ATTR {
    return RowPath(memory.rows[i / 2], job.setup.steps.row(y[i / 2]), space.width(), penalties,
                   i % 2 == 0 ? 1 : -1, memory.fronts[i]);
  };
  Paths paths = {path(0), path(1), path(2), path(3)};
  walkRows(space.tiles(), memory.rows, paths);
  for (int i = 0; i < job.rows.size(); ++i) {
    storeSums(job, y[i], memory.rows[i]);
  }
}

void runRowsOfBytes(const RowJob<std::uint8_t>& job, RowPaths::Memory& memory) {
  runRows(job, memory);
}
void runRowsOfWords(const RowJob<std::uint16_t>& job, RowPaths::Memory& memory) {
  runRows(job, memory);
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace cbmv
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cbmv {
namespace {

HWY_EXPORT(runRowsOfBytes);
HWY_EXPORT(runRowsOfWords);

void runRows(const RowJob<std::uint8_t>& job, RowPaths::Memory& memory) {
  HWY_DYNAMIC_DISPATCH(runRowsOfBytes)(job, memory);
}
void runRows(const RowJob<std::uint16_t>& job, RowPaths::Memory& memory) {
  HWY_DYNAMIC_DISPATCH(runRowsOfWords)(job, memory);
}

/// Largest number of lanes that a transposition writes after a run.
constexpr int kSpill = 7;

/// Largest number of lanes of a tile. Gaps are not wider than the missing disparities.
int mostLanes(int disparities) { return roundUp(disparities, kMostLanes); }

}  // namespace

void LaneRow::resize(const SearchSpace& space) {
  const auto tile_count = static_cast<std::size_t>(space.tiles());
  const std::size_t entries = mostEntriesOfRow(space);
  // Every hypothesis may have two free lanes beside it. strideOf rounds up twice.
  const std::size_t lanes = std::min(tile_count * mostLanes(space.range().count + kSpill),
                                     3 * entries + tile_count * (kSpill + kMostLanes - 1));
  tiles.resize(tile_count);
  runs.resize(entries + tile_count);
  matching.resize(lanes * (kTileColumns + 1) + kMostLanes);
  costs.resize(lanes * kTileColumns);
}

void RowFront::resize(int disparities) {
  const std::size_t lanes = mostLanes(disparities + kSpill);
  for (Costs& costs : costs_) {
    costs.assign(kMostLanes + lanes + kMostLanes, kNoPath);
  }
  previous_.assign(kMostLanes + disparities + kMostLanes + 2, kNoPath);
  along_.resize(lanes + kMostLanes);
  beside_.resize(lanes + kMostLanes);
}

void RowPaths::resize(const PathSetup& setup) {
  setup_ = &setup;
  const int disparities = setup.space->range().count;
  for (LaneRow& row : memory_.rows) {
    row.resize(*setup.space);
  }
  for (RowFront& front : memory_.fronts) {
    front.resize(disparities);
  }
}

template <typename Cost>
void RowPaths::run(const WindowedVolume<Cost>& costs, const cv::Range& rows,
                   WindowedAggregatedVolume& sums) {
  runRows(RowJob<Cost>{*setup_, costs, sums, rows}, memory_);
}

template void RowPaths::run(const WindowedMatchingVolume&, const cv::Range&,
                            WindowedAggregatedVolume&);
template void RowPaths::run(const WindowedAggregatedVolume&, const cv::Range&,
                            WindowedAggregatedVolume&);

}  // namespace cbmv
#endif  // HWY_ONCE
