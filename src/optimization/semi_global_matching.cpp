#include "cbmv_stereo/optimization/semi_global_matching.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include "optimization/matching_row.h"
#include "optimization/path_rows.h"

#include "cbmv_stereo/error.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "optimization/semi_global_matching.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

#include "optimization/cost_vectors-inl.h"

HWY_BEFORE_NAMESPACE();
namespace cbmv {
namespace HWY_NAMESPACE {
namespace {

using PathTag = LineTag<PathCost>;
using SumTag = LineTag<std::uint16_t>;
using PathVector = hn::Vec<PathTag>;

/// What becomes of the costs of a path in the sums.
enum class Accumulation { kSet, kAdd, kAddAndAverage };

template <Accumulation accumulation>
HWY_INLINE hn::Vec<SumTag> accumulate(PathVector costs, const std::uint16_t* sums) {
  const SumTag tag;
  const auto unsigned_costs = hn::BitCast(tag, costs);
  if constexpr (accumulation == Accumulation::kSet) {
    return unsigned_costs;
  } else {
    const auto sum = hn::Add(hn::LoadU(tag, sums), unsigned_costs);
    return accumulation == Accumulation::kAdd ? sum
                                              : hn::ShiftRight<2>(hn::Add(sum, hn::Set(tag, 2)));
  }
}

/// The recurrence of the header for one vector of hypotheses of a pixel.
template <typename Cost>
HWY_INLINE PathVector pathCosts(const Cost* costs, const PathCost* previous,
                                PathVector lowest_previous, const PathCost* p1,
                                const PathCost* p2) {
  const PathTag tag;
  const auto neighbours = hn::Min(hn::LoadU(tag, previous - 1), hn::LoadU(tag, previous + 1));
  const auto step = hn::Add(neighbours, hn::LoadU(tag, p1));
  const auto jump = hn::Add(lowest_previous, hn::LoadU(tag, p2));
  const auto best = hn::Min(hn::Min(hn::Load(tag, previous), step), jump);
  const auto matching = hn::BitCast(tag, loadWidened(SumTag(), costs));
  return hn::Add(matching, hn::Sub(best, lowest_previous));
}

/// Adds the pixel in `column` to a path. Returns the smallest of the new path costs in all lanes.
template <Accumulation accumulation, typename Cost>
HWY_INLINE PathVector extendPath(const PathPixels<Cost>& pixels, const RowPenalties& penalties,
                                 int column, const PathCost* previous, PathVector lowest_previous,
                                 PathCost* current) {
  const PathTag tag;
  const auto lanes = static_cast<int>(hn::Lanes(tag));
  const int disparities = pixels.disparities;
  const std::ptrdiff_t first = static_cast<std::ptrdiff_t>(column) * disparities;
  const Cost* costs = pixels.costs + first;
  std::uint16_t* sums = pixels.sums + first;
  const int edge = penalties.edges[column] != 0 ? 1 : 0;
  const PathCost* p1 = penalties.p1[edge] + column * penalties.step;
  const PathCost* p2 = penalties.p2[edge] + column * penalties.step;
  auto lowest = hn::Set(tag, kGuard);
  int h = 0;
  for (; h + lanes <= disparities; h += lanes) {
    const auto cost = pathCosts(costs + h, previous + h, lowest_previous, p1 + h, p2 + h);
    lowest = hn::Min(lowest, cost);
    hn::Store(cost, tag, current + h);
    hn::StoreU(accumulate<accumulation>(cost, sums + h), SumTag(), sums + h);
  }
  if (h < disparities) {
    const auto some = pathCosts(costs + h, previous + h, lowest_previous, p1 + h, p2 + h);
    const auto cost = hn::IfThenElse(hn::FirstN(tag, disparities - h), some, hn::Set(tag, kGuard));
    lowest = hn::Min(lowest, cost);
    hn::Store(cost, tag, current + h);
    storeFirst(SumTag(), accumulate<accumulation>(cost, sums + h), disparities - h, sums + h);
  }
  return hn::MinOfLanes(tag, lowest);
}

/// One step of vertical paths.
template <Accumulation accumulation, typename Cost>
HWY_INLINE void extendColumns(const PathPixels<Cost> pixels, const RowPenalties penalties,
                              const PathEnds ends) {
  const PathTag tag;
  for (int i = 0; i < pixels.columns; ++i) {
    const auto lowest =
        extendPath<accumulation>(pixels, penalties, i, ends.previous + i * ends.stride,
                                 hn::Set(tag, ends.lowest[i]), ends.current + i * ends.stride);
    ends.lowest[i] = hn::GetLane(lowest);
  }
}

void addColumnsOfBytes(const PathPixels<std::uint8_t>& pixels, const RowPenalties& penalties,
                       const PathEnds& ends) {
  extendColumns<Accumulation::kAdd>(pixels, penalties, ends);
}
void addColumnsOfWords(const PathPixels<std::uint16_t>& pixels, const RowPenalties& penalties,
                       const PathEnds& ends) {
  extendColumns<Accumulation::kAdd>(pixels, penalties, ends);
}
void averageColumnsOfBytes(const PathPixels<std::uint8_t>& pixels, const RowPenalties& penalties,
                           const PathEnds& ends) {
  extendColumns<Accumulation::kAddAndAverage>(pixels, penalties, ends);
}
void averageColumnsOfWords(const PathPixels<std::uint16_t>& pixels, const RowPenalties& penalties,
                           const PathEnds& ends) {
  extendColumns<Accumulation::kAddAndAverage>(pixels, penalties, ends);
}

/// Both paths along a row, at once since each of them waits for its previous pixel all the time:
/// whichever comes first to a pixel sets the sums. Path 0 of the ends is from the left, path 1 from
/// the right.
template <typename Cost>
HWY_INLINE void extendBothWays(const PathPixels<Cost> pixels, const RowPenalties from_left,
                               const RowPenalties from_right, const PathEnds ends) {
  auto* previous = ends.previous;
  auto* current = ends.current;
  auto left = hn::Zero(PathTag());
  auto right = left;
  const int last = pixels.columns - 1;
  const auto extend = [&](auto set_left, auto set_right, int i) {
    left = extendPath<set_left()>(pixels, from_left, i, previous, left, current);
    right = extendPath<set_right()>(pixels, from_right, last - i, previous + ends.stride, right,
                                    current + ends.stride);
    std::swap(previous, current);
  };
  const std::integral_constant<Accumulation, Accumulation::kSet> set;
  const std::integral_constant<Accumulation, Accumulation::kAdd> add;
  int i = 0;
  for (; 2 * i < last; ++i) {
    extend(set, set, i);
  }
  if (2 * i == last) {
    extend(set, add, i++);
  }
  for (; i <= last; ++i) {
    extend(add, add, i);
  }
}

void setRowOfBytes(const PathPixels<std::uint8_t>& pixels, const RowPenalties& from_left,
                   const RowPenalties& from_right, const PathEnds& ends) {
  extendBothWays(pixels, from_left, from_right, ends);
}
void setRowOfWords(const PathPixels<std::uint16_t>& pixels, const RowPenalties& from_left,
                   const RowPenalties& from_right, const PathEnds& ends) {
  extendBothWays(pixels, from_left, from_right, ends);
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace cbmv
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cbmv {
namespace {

HWY_EXPORT(addColumnsOfBytes);
HWY_EXPORT(addColumnsOfWords);
HWY_EXPORT(averageColumnsOfBytes);
HWY_EXPORT(averageColumnsOfWords);
HWY_EXPORT(setRowOfBytes);
HWY_EXPORT(setRowOfWords);

void addColumns(const PathPixels<std::uint8_t>& pixels, const RowPenalties& penalties,
                const PathEnds& ends) {
  HWY_DYNAMIC_DISPATCH(addColumnsOfBytes)(pixels, penalties, ends);
}
void addColumns(const PathPixels<std::uint16_t>& pixels, const RowPenalties& penalties,
                const PathEnds& ends) {
  HWY_DYNAMIC_DISPATCH(addColumnsOfWords)(pixels, penalties, ends);
}
void averageColumns(const PathPixels<std::uint8_t>& pixels, const RowPenalties& penalties,
                    const PathEnds& ends) {
  HWY_DYNAMIC_DISPATCH(averageColumnsOfBytes)(pixels, penalties, ends);
}
void averageColumns(const PathPixels<std::uint16_t>& pixels, const RowPenalties& penalties,
                    const PathEnds& ends) {
  HWY_DYNAMIC_DISPATCH(averageColumnsOfWords)(pixels, penalties, ends);
}
void setRow(const PathPixels<std::uint8_t>& pixels, const RowPenalties& from_left,
            const RowPenalties& from_right, const PathEnds& ends) {
  HWY_DYNAMIC_DISPATCH(setRowOfBytes)(pixels, from_left, from_right, ends);
}
void setRow(const PathPixels<std::uint16_t>& pixels, const RowPenalties& from_left,
            const RowPenalties& from_right, const PathEnds& ends) {
  HWY_DYNAMIC_DISPATCH(setRowOfWords)(pixels, from_left, from_right, ends);
}

/// Vertical paths advance this many columns at once: wide enough to read whole pages, narrow enough
/// to keep two rows of path costs close to the core.
constexpr int kColumnsPerBlock = 64;
/// Rows of a band: enough to keep all threads busy between two waits for each other.
constexpr int kRowsPerThread = 4;

/// Penalties in units of 1/255, indexed by the number of images that have an edge.
struct Penalties {
  std::array<PathCost, 3> p1;
  std::array<PathCost, 3> p2;
};

Penalties makePenalties(const SgmOptions& options, double p1_divisor) {
  const std::array<double, 3> divisors = {1.0, options.q1,
                                          static_cast<double>(options.q1) * options.q2};
  Penalties penalties{};
  for (std::size_t edges = 0; edges < divisors.size(); ++edges) {
    penalties.p1[edges] =
        static_cast<PathCost>(std::lround(255.0 * options.p1 / (divisors[edges] * p1_divisor)));
    penalties.p2[edges] = static_cast<PathCost>(std::lround(255.0 * options.p2 / divisors[edges]));
  }
  return penalties;
}

void checkOptions(const SgmOptions& options) {
  if (!(options.p1 >= 0 && options.p1 <= options.p2)) {
    throw Error("The penalty p1 of semi-global matching is " + std::to_string(options.p1) +
                "; it must lie between 0 and p2, which is " + std::to_string(options.p2) + ".");
  }
  if (!(255.0 * options.p2 <= kMaxPathCost)) {
    throw Error("The penalty p2 of semi-global matching is " + std::to_string(options.p2) +
                "; it must be at most " + std::to_string(kMaxPathCost / 255.0) + ".");
  }
  if (!(options.q1 >= 1 && options.q2 >= 1 && options.alpha1 >= 1)) {
    throw Error("The divisors q1, q2 and alpha1 of semi-global matching are " +
                std::to_string(options.q1) + ", " + std::to_string(options.q2) + " and " +
                std::to_string(options.alpha1) + "; each must be at least 1.");
  }
}

/// Steps of an image that count as edges: non-zero at (y, x) where there is one between (y, x) and
/// its left neighbour (`horizontal`) or its upper neighbour (`vertical`). One row and one column
/// larger than the image, zero where a neighbour is missing.
struct EdgeMaps {
  cv::Mat horizontal;
  cv::Mat vertical;
};

EdgeMaps findEdges(const cv::Mat& grey, float threshold_grey) {
  const cv::Rect all(0, 0, grey.cols, grey.rows);
  const auto mark_steps = [&](const cv::Point& neighbour) {
    cv::Mat edges = cv::Mat::zeros(grey.rows + 1, grey.cols + 1, CV_8UC1);
    const cv::Rect pixels = all & (all + neighbour);
    if (!pixels.empty()) {
      cv::Mat steps;
      cv::absdiff(grey(pixels), grey(pixels - neighbour), steps);
      cv::compare(steps, threshold_grey, edges(pixels), cv::CMP_GE);
    }
    return edges;
  };
  return {mark_steps({1, 0}), mark_steps({0, 1})};
}

/// Penalties of all hypotheses of the pixels of one row, or of a part of one.
class PenaltyRow {
 public:
  PenaltyRow(View view, const cv::Range& columns, const DisparityRange& range, int width,
             const Penalties& penalties)
      : first_column_(columns.start),
        width_(width),
        penalties_(penalties),
        other_edges_(view, columns, range) {
    for (std::size_t edge = 0; edge < 2; ++edge) {
      p1_[edge].resize(other_edges_.size());
      p2_[edge].resize(other_edges_.size());
    }
  }

  /// Edges towards the previous pixel of the path, by column of the reference and the other image.
  RowPenalties fill(const std::uint8_t* reference_edges, const std::uint8_t* other_edges) {
    other_edges_.fill(width_, 0, [other_edges](int column) { return other_edges[column]; });
    for (std::size_t edge = 0; edge < 2; ++edge) {
      select(penalties_.p1[edge], penalties_.p1[edge + 1], p1_[edge]);
      select(penalties_.p2[edge], penalties_.p2[edge + 1], p2_[edge]);
    }
    const std::ptrdiff_t first = other_edges_.offset(first_column_);
    return {reference_edges + first_column_,
            {p1_[0].data() + first, p1_[1].data() + first},
            {p2_[0].data() + first, p2_[1].data() + first},
            other_edges_.offset(first_column_ + 1) - first};
  }

 private:
  using Table = std::array<std::vector<PathCost>, 2>;  // by edge in the reference image

  void select(PathCost without_edge, PathCost with_edge, std::vector<PathCost>& penalties) const {
    const std::uint8_t* edges = other_edges_.data();
    for (std::size_t i = 0; i < penalties.size(); ++i) {
      penalties[i] = edges[i] != 0 ? with_edge : without_edge;
    }
  }

  int first_column_;
  int width_;
  const Penalties& penalties_;
  MatchingRow<std::uint8_t> other_edges_;
  Table p1_;
  Table p2_;
};

/// Memory of neighbouring paths of one direction.
class PathFront {
 public:
  PathFront(int paths, int disparities)
      : stride_((disparities + kLine) / kLine * kLine),
        lowest_(paths),
        previous_(kLine + paths * stride_, kGuard),
        current_(previous_) {}

  /// Starts anew with all costs zero, from which the first step leads to L_r = C.
  void reset(int disparities) {
    for (std::size_t i = 0; i < lowest_.size(); ++i) {
      std::fill_n(previous_.begin() + kLine + static_cast<std::ptrdiff_t>(i) * stride_, disparities,
                  PathCost{0});
    }
    std::fill(lowest_.begin(), lowest_.end(), PathCost{0});
  }

  PathEnds ends() {
    return {previous_.data() + kLine, current_.data() + kLine, lowest_.data(), stride_};
  }

  /// To be called when all paths have been extended.
  void advance() { previous_.swap(current_); }

 private:
  /// Elements of a cache line, where a path's costs start.
  static constexpr std::ptrdiff_t kLine = 64 / sizeof(PathCost);
  using Costs = std::vector<PathCost, CacheLineAllocator<PathCost>>;

  std::ptrdiff_t stride_;  // leaves at least one guard behind the costs
  std::vector<PathCost> lowest_;
  Costs previous_;
  Costs current_;
};

/// What all paths have in common.
template <typename Cost>
struct Inputs {
  Inputs(const Volume<Cost>& all_costs, const EdgeImages& images, View reference_view,
         const DisparityRange& disparities, const SgmOptions& options)
      : costs(all_costs),
        view(reference_view),
        range(disparities),
        reference(findEdges(images.reference, images.reference_threshold_grey)),
        other(findEdges(images.other, images.other_threshold_grey)),
        horizontal(makePenalties(options, 1.0)),
        vertical(makePenalties(options, options.alpha1)) {}

  PathPixels<Cost> pixels(int y, const cv::Range& columns, OptimizedVolume& sums) const {
    return {costs.pixel(y, columns.start), sums.pixel(y, columns.start), columns.size(),
            range.count};
  }

  const Volume<Cost>& costs;
  const View view;
  const DisparityRange range;
  const EdgeMaps reference;
  const EdgeMaps other;
  const Penalties horizontal;
  const Penalties vertical;
};

/// The paths along rows.
template <typename Cost>
class RowPaths {
 public:
  explicit RowPaths(const Inputs<Cost>& inputs)
      : inputs_(inputs),
        columns_(0, inputs.costs.width()),
        from_left_(inputs.view, columns_, inputs.range, columns_.end, inputs.horizontal),
        from_right_(from_left_),
        front_(2, inputs.range.count) {}

  /// Sets the sums of a row.
  void run(int y, OptimizedVolume& sums) {
    // An edge is stored at the right one of two pixels.
    const auto* reference = inputs_.reference.horizontal.template ptr<std::uint8_t>(y);
    const auto* other = inputs_.other.horizontal.template ptr<std::uint8_t>(y);
    front_.reset(inputs_.range.count);
    setRow(inputs_.pixels(y, columns_, sums), from_left_.fill(reference, other),
           from_right_.fill(reference + 1, other + 1), front_.ends());
  }

 private:
  const Inputs<Cost>& inputs_;
  cv::Range columns_;
  PenaltyRow from_left_;
  PenaltyRow from_right_;
  PathFront front_;
};

/// The paths along some neighbouring columns, first from above, then from below.
template <typename Cost>
class ColumnPaths {
 public:
  ColumnPaths(const Inputs<Cost>& inputs, const cv::Range& columns)
      : inputs_(inputs),
        columns_(columns),
        penalties_(inputs.view, columns, inputs.range, inputs.costs.width(), inputs.vertical),
        front_(columns.size(), inputs.range.count) {
    front_.reset(inputs.range.count);
  }

  /// Adds the paths from above to the sums of the next rows.
  void runDown(const cv::Range& rows, OptimizedVolume& sums) {
    for (int y = rows.start; y < rows.end; ++y) {
      addColumns(inputs_.pixels(y, columns_, sums), fillPenalties(y), front_.ends());
      front_.advance();
    }
  }

  /// Adds the paths from below to the sums of all rows and turns these to means.
  void runUp(OptimizedVolume& sums) {
    front_.reset(inputs_.range.count);
    for (int y = inputs_.costs.height() - 1; y >= 0; --y) {
      averageColumns(inputs_.pixels(y, columns_, sums), fillPenalties(y + 1), front_.ends());
      front_.advance();
    }
  }

 private:
  /// Of the edge between the rows `lower` and `lower` − 1.
  RowPenalties fillPenalties(int lower) {
    return penalties_.fill(inputs_.reference.vertical.template ptr<std::uint8_t>(lower),
                           inputs_.other.vertical.template ptr<std::uint8_t>(lower));
  }

  const Inputs<Cost>& inputs_;
  cv::Range columns_;
  PenaltyRow penalties_;
  PathFront front_;
};

/// Runs over the volumes twice. Downwards in bands of rows, first along these, then along the
/// columns, while the band is still in the cache; upwards along the columns.
template <typename Cost>
void addPaths(const Inputs<Cost>& inputs, OptimizedVolume& sums) {
  const int width = inputs.costs.width();
  const int height = inputs.costs.height();
  std::vector<ColumnPaths<Cost>> blocks;
  for (int x = 0; x < width; x += kColumnsPerBlock) {
    blocks.emplace_back(inputs, cv::Range(x, std::min(x + kColumnsPerBlock, width)));
  }
  tbb::enumerable_thread_specific<RowPaths<Cost>> row_paths(std::cref(inputs));
  const int band_rows = kRowsPerThread * tbb::this_task_arena::max_concurrency();
  for (int first = 0; first < height; first += band_rows) {
    const cv::Range band(first, std::min(first + band_rows, height));
    tbb::parallel_for(band.start, band.end, [&](int y) { row_paths.local().run(y, sums); });
    tbb::parallel_for(std::size_t{0}, blocks.size(),
                      [&](std::size_t i) { blocks[i].runDown(band, sums); });
  }
  tbb::parallel_for(std::size_t{0}, blocks.size(), [&](std::size_t i) { blocks[i].runUp(sums); });
}

template <typename Cost>
void match(const Volume<Cost>& costs, const EdgeImages& images, View view,
           const DisparityRange& range, const SgmOptions& options, OptimizedVolume& mean) {
  const cv::Size size(costs.width(), costs.height());
  CV_Assert(images.reference.type() == CV_8UC1 && images.reference.size() == size);
  CV_Assert(images.other.type() == CV_8UC1 && images.other.size() == size);
  CV_Assert(costs.disparities() == range.count);
  checkOptions(options);

  mean.resize(costs.height(), costs.width(), costs.disparities());
  addPaths(Inputs<Cost>(costs, images, view, range, options), mean);
}

}  // namespace

void semiGlobalMatching(const OptimizedVolume& costs, const EdgeImages& images, View view,
                        const DisparityRange& range, const SgmOptions& options,
                        OptimizedVolume& mean) {
  CV_Assert(&costs != &mean);
  match(costs, images, view, range, options, mean);
}

void semiGlobalMatching(const MatchingVolume& costs, const EdgeImages& images, View view,
                        const DisparityRange& range, const SgmOptions& options,
                        OptimizedVolume& mean) {
  match(costs, images, view, range, options, mean);
}

int sgmCostBound(const SgmOptions& options) {
  const double bound = 255.0 + options.iterations * std::round(255.0 * options.p2);
  return static_cast<int>(std::min<double>(bound, std::numeric_limits<int>::max()));
}

}  // namespace cbmv
#endif  // HWY_ONCE
