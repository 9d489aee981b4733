#include "cbmv_stereo/optimization/semi_global_matching.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <type_traits>
#include <utility>
#include <vector>

#include <tbb/parallel_for.h>

#include "optimization/matching_row.h"
#include "optimization/path_rows.h"
#include "optimization/sgm_penalties.h"

#include "cbmv_stereo/optimization/surface_prior.h"
#include "cbmv_stereo/volume/per_thread.h"

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

/// Of the first `count` lanes.
template <Accumulation accumulation>
HWY_INLINE hn::Vec<SumTag> accumulate(PathVector costs, [[maybe_unused]] const std::uint16_t* sums,
                                      [[maybe_unused]] int count) {
  const SumTag tag;
  const auto unsigned_costs = hn::BitCast(tag, costs);
  if constexpr (accumulation == Accumulation::kSet) {
    return unsigned_costs;
  } else {
    const auto sum = hn::Add(loadFirst(tag, sums, count), unsigned_costs);
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
  const auto best = hn::Min(hn::Min(hn::LoadU(tag, previous), step), jump);
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
  previous -= penalties.rises[column];
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
    hn::StoreU(accumulate<accumulation>(cost, sums + h, lanes), SumTag(), sums + h);
  }
  if (h < disparities) {
    const auto some = pathCosts(costs + h, previous + h, lowest_previous, p1 + h, p2 + h);
    const auto cost = hn::IfThenElse(hn::FirstN(tag, disparities - h), some, hn::Set(tag, kGuard));
    lowest = hn::Min(lowest, cost);
    hn::Store(cost, tag, current + h);
    const int rest = disparities - h;
    storeFirst(SumTag(), accumulate<accumulation>(cost, sums + h, rest), rest, sums + h);
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

/// Steps of an image that count as edges: non-zero at (y, x) where there is one between (y, x) and
/// its left neighbour (`horizontal`) or its upper neighbour (`vertical`). One row and one column
/// larger than the image, zero where a neighbour is missing.
struct EdgeMaps {
  cv::Mat horizontal;
  cv::Mat vertical;
};

/// Whether each of `count` pixels differs from the one `distance` before it by at least
/// `lowest_step` grey levels.
void markSteps(const std::uint8_t* pixels, std::ptrdiff_t distance, int count, int lowest_step,
               std::uint8_t* edges) {
  const std::uint8_t* neighbours = pixels - distance;
  for (int x = 0; x < count; ++x) {
    const int step = std::abs(pixels[x] - neighbours[x]);
    edges[x] = static_cast<std::uint8_t>(step >= lowest_step ? 1 : 0);
  }
}

void findEdges(const cv::Mat& grey, float threshold_grey, EdgeMaps& edges) {
  const cv::Size size(grey.cols + 1, grey.rows + 1);
  edges.horizontal.create(size, CV_8UC1);
  edges.vertical.create(size, CV_8UC1);
  // A whole number reaches the threshold exactly when it reaches the threshold rounded up.
  const int lowest_step = static_cast<int>(std::ceil(std::clamp(threshold_grey, 0.0F, 256.0F)));
  const auto stride = static_cast<std::ptrdiff_t>(grey.step1());
  tbb::parallel_for(0, size.height, [&](int y) {
    auto* horizontal = edges.horizontal.ptr<std::uint8_t>(y);
    auto* vertical = edges.vertical.ptr<std::uint8_t>(y);
    std::fill_n(horizontal, size.width, std::uint8_t{0});
    std::fill_n(vertical, size.width, std::uint8_t{0});
    if (y < grey.rows) {
      const auto* pixels = grey.ptr<std::uint8_t>(y);
      markSteps(pixels + 1, 1, grey.cols - 1, lowest_step, horizontal + 1);
      if (y > 0) {
        markSteps(pixels, stride, grey.cols, lowest_step, vertical);
      }
    }
  });
}

/// What all paths have in common beside the costs.
struct PathSetup {
  View view = View::kLeft;
  DisparityRange range;
  int width = 0;
  int height = 0;
  SgmPenalties horizontal{};
  SgmPenalties vertical{};
  EdgeMaps reference;
  EdgeMaps other;
  cv::Mat surface;  // with a border of one pixel without a surface; empty: none anywhere

  /// The surface at the pixels (x + dx, y); nullptr if there is none.
  const std::int16_t* surfaceRow(int y, int dx = 0) const {
    return surface.empty() ? nullptr : surface.ptr<std::int16_t>(y + 1) + 1 + dx;
  }
};

/// Two neighbouring rows or columns of pixels, the second one next on the path. Pointers are to the
/// first column of the image.
struct PathStep {
  const std::uint8_t* reference_edges;
  const std::uint8_t* other_edges;
  const std::int16_t* surface;  // nullptr: unknown
  const std::int16_t* previous_surface;
};

/// How far the surface rises from one pixel to the next. Where that is more than a disparity, the
/// two pixels rather see two surfaces.
std::int8_t surfaceRise(std::int16_t previous, std::int16_t next) {
  const int rise = next - previous;
  return previous != kNoSurface && next != kNoSurface && std::abs(rise) <= 1
             ? static_cast<std::int8_t>(rise)
             : std::int8_t{0};
}

/// Penalties of all hypotheses of the pixels of one row, or of a part of one.
class PenaltyRow {
 public:
  void resize(const PathSetup& setup, const cv::Range& columns, const SgmPenalties& penalties) {
    first_column_ = columns.start;
    width_ = setup.width;
    penalties_ = penalties;
    other_edges_.resize(setup.view, columns, setup.range);
    for (std::size_t edge = 0; edge < 2; ++edge) {
      p1_[edge].resize(other_edges_.size() + kReadableBytesBeyond / sizeof(PathCost));
      p2_[edge].resize(p1_[edge].size());
    }
    rises_.assign(columns.size(), 0);
  }

  RowPenalties fill(const PathStep& step) {
    other_edges_.fill(step.other_edges, width_, 0);
    for (std::size_t edge = 0; edge < 2; ++edge) {
      select(penalties_.p1[edge], penalties_.p1[edge + 1], p1_[edge]);
      select(penalties_.p2[edge], penalties_.p2[edge + 1], p2_[edge]);
    }
    if (step.surface != nullptr) {
      const std::int16_t* surface = step.surface + first_column_;
      const std::int16_t* previous = step.previous_surface + first_column_;
      std::transform(previous, previous + rises_.size(), surface, rises_.begin(), surfaceRise);
    }
    const std::ptrdiff_t first = other_edges_.offset(first_column_);
    return {step.reference_edges + first_column_,
            {p1_[0].data() + first, p1_[1].data() + first},
            {p2_[0].data() + first, p2_[1].data() + first},
            other_edges_.offset(first_column_ + 1) - first,
            rises_.data()};
  }

 private:
  using Table = std::array<std::vector<PathCost>, 2>;  // by edge in the reference image

  void select(PathCost without_edge, PathCost with_edge, std::vector<PathCost>& penalties) const {
    const std::uint8_t* edges = other_edges_.data();
    PathCost* out = penalties.data();
    for (int i = 0; i < other_edges_.size(); ++i) {
      out[i] = edges[i] != 0 ? with_edge : without_edge;
    }
  }

  int first_column_ = 0;
  int width_ = 0;
  SgmPenalties penalties_{};
  MatchingRow<std::uint8_t> other_edges_;
  Table p1_;
  Table p2_;
  std::vector<std::int8_t> rises_;
};

/// Memory of neighbouring paths of one direction.
class PathFront {
 public:
  void resize(int paths, int disparities) {
    stride_ = (disparities + 1 + kLine) / kLine * kLine;
    disparities_ = disparities;
    lowest_.resize(paths);
    previous_.assign(kLine + paths * stride_ + kLine, kGuard);
    current_.assign(previous_.size(), kGuard);
  }

  /// Starts anew with all costs zero, from which the first step leads to L_r = C.
  void reset() {
    for (std::size_t i = 0; i < lowest_.size(); ++i) {
      std::fill_n(previous_.begin() + kLine + static_cast<std::ptrdiff_t>(i) * stride_,
                  disparities_, PathCost{0});
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

  std::ptrdiff_t stride_ = 0;  // leaves at least two guards behind the costs
  int disparities_ = 0;
  std::vector<PathCost> lowest_;
  Costs previous_;
  Costs current_;
};

template <typename Cost>
PathPixels<Cost> pixelsOf(const Volume<Cost>& costs, int y, const cv::Range& columns,
                          OptimizedVolume& sums) {
  return {costs.pixel(y, columns.start), sums.pixel(y, columns.start), columns.size(),
          costs.disparities()};
}

/// The paths along rows.
class RowPaths {
 public:
  void resize(const PathSetup& setup) {
    setup_ = &setup;
    columns_ = cv::Range(0, setup.width);
    from_left_.resize(setup, columns_, setup.horizontal);
    from_right_.resize(setup, columns_, setup.horizontal);
    front_.resize(2, setup.range.count);
  }

  /// Sets the sums of a row.
  template <typename Cost>
  void run(const Volume<Cost>& costs, int y, OptimizedVolume& sums) {
    // An edge is stored at the right one of two pixels.
    const auto* reference = setup_->reference.horizontal.ptr<std::uint8_t>(y);
    const auto* other = setup_->other.horizontal.ptr<std::uint8_t>(y);
    front_.reset();
    setRow(pixelsOf(costs, y, columns_, sums),
           from_left_.fill({reference, other, setup_->surfaceRow(y), setup_->surfaceRow(y, -1)}),
           from_right_.fill(
               {reference + 1, other + 1, setup_->surfaceRow(y), setup_->surfaceRow(y, 1)}),
           front_.ends());
  }

 private:
  const PathSetup* setup_ = nullptr;
  cv::Range columns_;
  PenaltyRow from_left_;
  PenaltyRow from_right_;
  PathFront front_;
};

/// The paths along some neighbouring columns, first from above, then from below.
class ColumnPaths {
 public:
  void resize(const PathSetup& setup, const cv::Range& columns) {
    setup_ = &setup;
    columns_ = columns;
    penalties_.resize(setup, columns, setup.vertical);
    front_.resize(columns.size(), setup.range.count);
    front_.reset();
  }

  /// Adds the paths from above to the sums of the next rows.
  template <typename Cost>
  void runDown(const Volume<Cost>& costs, const cv::Range& rows, OptimizedVolume& sums) {
    for (int y = rows.start; y < rows.end; ++y) {
      addColumns(pixelsOf(costs, y, columns_, sums), fillPenalties(y, y - 1), front_.ends());
      front_.advance();
    }
  }

  /// Adds the paths from below to the sums of all rows and turns these to means.
  template <typename Cost>
  void runUp(const Volume<Cost>& costs, OptimizedVolume& sums) {
    front_.reset();
    for (int y = costs.height() - 1; y >= 0; --y) {
      averageColumns(pixelsOf(costs, y, columns_, sums), fillPenalties(y, y + 1), front_.ends());
      front_.advance();
    }
  }

 private:
  /// Of the step from row `previous` to row `y`; an edge is stored at the lower one of both.
  RowPenalties fillPenalties(int y, int previous) {
    const int lower = std::max(y, previous);
    return penalties_.fill({setup_->reference.vertical.ptr<std::uint8_t>(lower),
                            setup_->other.vertical.ptr<std::uint8_t>(lower), setup_->surfaceRow(y),
                            setup_->surfaceRow(previous)});
  }

  const PathSetup* setup_ = nullptr;
  cv::Range columns_;
  PenaltyRow penalties_;
  PathFront front_;
};

}  // namespace

class SemiGlobalMatcher::Impl {
 public:
  template <typename Cost>
  void match(const Volume<Cost>& costs, const EdgeImages& images, const cv::Mat& surface, View view,
             const DisparityRange& range, const SgmOptions& options, OptimizedVolume& mean) {
    const cv::Size size(costs.width(), costs.height());
    CV_Assert(images.reference.type() == CV_8UC1 && images.reference.size() == size);
    CV_Assert(images.other.type() == CV_8UC1 && images.other.size() == size);
    CV_Assert(costs.disparities() == range.count);
    checkSgmOptions(options);

    mean.resize(costs.height(), costs.width(), costs.disparities());
    setup_.view = view;
    setup_.range = range;
    setup_.width = size.width;
    setup_.height = size.height;
    setup_.horizontal = makePenalties(options, 1.0);
    setup_.vertical = makePenalties(options, options.alpha1);
    findEdges(images.reference, images.reference_threshold_grey, setup_.reference);
    findEdges(images.other, images.other_threshold_grey, setup_.other);
    takeSurface(surface, size);
    preparePaths();
    addPaths(costs, mean);
  }

 private:
  void takeSurface(const cv::Mat& surface, const cv::Size& size) {
    if (surface.empty()) {
      setup_.surface.release();
    } else {
      CV_Assert(surface.type() == CV_16SC1 && surface.size() == size);
      setup_.surface.create(size.height + 2, size.width + 2, CV_16SC1);
      tbb::parallel_for(0, size.height + 2, [&](int row) {
        auto* out = setup_.surface.ptr<std::int16_t>(row);
        std::fill_n(out, size.width + 2, kNoSurface);
        if (row >= 1 && row <= size.height) {
          std::copy_n(surface.ptr<std::int16_t>(row - 1), size.width, out + 1);
        }
      });
    }
  }

  void preparePaths() {
    const int width = setup_.width;
    blocks_.resize((width + kColumnsPerBlock - 1) / kColumnsPerBlock);
    for (std::size_t i = 0; i < blocks_.size(); ++i) {
      const int x = static_cast<int>(i) * kColumnsPerBlock;
      blocks_[i].resize(setup_, cv::Range(x, std::min(x + kColumnsPerBlock, width)));
    }
    rows_.prepare([&](RowPaths& paths) { paths.resize(setup_); });
  }

  /// Runs over the volumes twice. Downwards in bands of rows, first along these, then along the
  /// columns, while the band is still in the cache; upwards along the columns.
  template <typename Cost>
  void addPaths(const Volume<Cost>& costs, OptimizedVolume& sums) {
    const int height = setup_.height;
    const int band_rows = kRowsPerThread * static_cast<int>(threadCount());
    for (int first = 0; first < height; first += band_rows) {
      const cv::Range band(first, std::min(first + band_rows, height));
      tbb::parallel_for(band.start, band.end, [&](int y) { rows_.local().run(costs, y, sums); });
      tbb::parallel_for(std::size_t{0}, blocks_.size(),
                        [&](std::size_t i) { blocks_[i].runDown(costs, band, sums); });
    }
    tbb::parallel_for(std::size_t{0}, blocks_.size(),
                      [&](std::size_t i) { blocks_[i].runUp(costs, sums); });
  }

  PathSetup setup_;
  std::vector<ColumnPaths> blocks_;
  PerThread<RowPaths> rows_;
};

SemiGlobalMatcher::SemiGlobalMatcher() : impl_(std::make_unique<Impl>()) {}
SemiGlobalMatcher::~SemiGlobalMatcher() = default;

void SemiGlobalMatcher::match(const OptimizedVolume& costs, const EdgeImages& images,
                              const cv::Mat& surface, View view, const DisparityRange& range,
                              const SgmOptions& options, OptimizedVolume& mean) {
  CV_Assert(&costs != &mean);
  impl_->match(costs, images, surface, view, range, options, mean);
}

void SemiGlobalMatcher::match(const MatchingVolume& costs, const EdgeImages& images,
                              const cv::Mat& surface, View view, const DisparityRange& range,
                              const SgmOptions& options, OptimizedVolume& mean) {
  impl_->match(costs, images, surface, view, range, options, mean);
}

}  // namespace cbmv
#endif  // HWY_ONCE
