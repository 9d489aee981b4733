#include "cbmv_stereo/optimization/semi_global_matching.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "matching_row.h"

#include "cbmv_stereo/error.h"

namespace cbmv {
namespace {

/// Signed, because SSE2 has a minimum of signed 16-bit lanes only.
using PathCost = std::int16_t;

constexpr int kMaxPathCost = 16383;
/// Above every path cost, and still representable with a penalty on top.
constexpr PathCost kGuard = kMaxPathCost + 1;
/// Vertical paths advance this many columns at once: wide enough to read whole cache lines, narrow
/// enough to keep two rows of path costs close to the core.
constexpr int kColumnsPerBlock = 32;

/// What becomes of the costs of a path in the output.
enum class Accumulation { kSet, kAdd, kAddAndAverage };

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
      : width_(width), penalties_(penalties), other_edges_(view, columns, range) {
    for (std::size_t edge = 0; edge < 2; ++edge) {
      p1_[edge].resize(other_edges_.size());
      p2_[edge].resize(other_edges_.size());
    }
  }

  /// Edges towards the previous pixel of the path, by column of the reference and the other image.
  void fill(const std::uint8_t* reference_edges, const std::uint8_t* other_edges) {
    reference_edges_ = reference_edges;
    other_edges_.fill(width_, 0, [other_edges](int column) { return other_edges[column]; });
    for (std::size_t edge = 0; edge < 2; ++edge) {
      select(penalties_.p1[edge], penalties_.p1[edge + 1], p1_[edge]);
      select(penalties_.p2[edge], penalties_.p2[edge + 1], p2_[edge]);
    }
  }

  const PathCost* p1(int x) const { return hypotheses(p1_, x); }
  const PathCost* p2(int x) const { return hypotheses(p2_, x); }

 private:
  using Table = std::array<std::vector<PathCost>, 2>;  // by edge in the reference image

  void select(PathCost without_edge, PathCost with_edge, std::vector<PathCost>& penalties) const {
    const std::uint8_t* edges = other_edges_.data();
    for (std::size_t i = 0; i < penalties.size(); ++i) {
      penalties[i] = edges[i] != 0 ? with_edge : without_edge;
    }
  }

  const PathCost* hypotheses(const Table& table, int x) const {
    return table[reference_edges_[x] != 0 ? 1 : 0].data() + other_edges_.offset(x);
  }

  int width_;
  const Penalties& penalties_;
  const std::uint8_t* reference_edges_ = nullptr;
  MatchingRow<std::uint8_t> other_edges_;
  Table p1_;
  Table p2_;
};

/// Adds one pixel to a path: the recurrence of the header. `previous` has a guard at −1 and
/// `disparities`. Returns the smallest of the new path costs.
template <Accumulation accumulation>
PathCost extendPath(const std::uint16_t* __restrict costs, const PathCost* __restrict previous,
                    PathCost lowest_previous, const PathCost* __restrict p1,
                    const PathCost* __restrict p2, int disparities, PathCost* __restrict current,
                    std::uint16_t* __restrict out) {
  PathCost lowest = kGuard;
  for (int i = 0; i < disparities; ++i) {
    const auto step = static_cast<PathCost>(std::min(previous[i - 1], previous[i + 1]) + p1[i]);
    const auto jump = static_cast<PathCost>(lowest_previous + p2[i]);
    const PathCost best = std::min(std::min(previous[i], step), jump);
    const auto cost = static_cast<PathCost>(costs[i] + best - lowest_previous);
    current[i] = cost;
    lowest = std::min(lowest, cost);
    if constexpr (accumulation == Accumulation::kSet) {
      out[i] = static_cast<std::uint16_t>(cost);
    } else if constexpr (accumulation == Accumulation::kAdd) {
      out[i] = static_cast<std::uint16_t>(out[i] + cost);
    } else {
      out[i] = static_cast<std::uint16_t>(out[i] + cost + 2) / 4;
    }
  }
  return lowest;
}

/// Where some neighbouring paths of one direction have got to: the path costs of their last pixels.
class PathFront {
 public:
  /// Starts with all costs zero, from which the first step leads to L_r = C.
  PathFront(int paths, int disparities)
      : disparities_(disparities),
        stride_(static_cast<std::size_t>(disparities) + 1),
        lowest_(paths),
        previous_(paths * stride_ + 1),
        current_(paths * stride_ + 1) {
    for (std::size_t i = 0; i < previous_.size(); i += stride_) {
      previous_[i] = current_[i] = kGuard;
    }
  }

  template <Accumulation accumulation>
  void extend(int path, const std::uint16_t* costs, const PathCost* p1, const PathCost* p2,
              std::uint16_t* out) {
    const std::size_t first = path * stride_ + 1;
    lowest_[path] = extendPath<accumulation>(costs, previous_.data() + first, lowest_[path], p1, p2,
                                             disparities_, current_.data() + first, out);
  }

  /// To be called when all paths have been extended.
  void advance() { previous_.swap(current_); }

 private:
  int disparities_;
  std::size_t stride_;
  std::vector<PathCost> lowest_;
  std::vector<PathCost> previous_;
  std::vector<PathCost> current_;
};

/// The four sweeps over a volume. Horizontal ones come first: they initialise the sums.
class Sweeps {
 public:
  Sweeps(const OptimizedVolume& costs, const EdgeImages& images, View view,
         const DisparityRange& range, const SgmOptions& options, OptimizedVolume& mean)
      : costs_(costs),
        view_(view),
        range_(range),
        reference_(findEdges(images.reference, images.reference_threshold_grey)),
        other_(findEdges(images.other, images.other_threshold_grey)),
        horizontal_(makePenalties(options, 1.0)),
        vertical_(makePenalties(options, options.alpha1)),
        mean_(mean) {}

  void alongRows(const cv::Range& rows) const {
    PenaltyRow penalties(view_, {0, costs_.width()}, range_, costs_.width(), horizontal_);
    for (int y = rows.start; y < rows.end; ++y) {
      alongRow<Accumulation::kSet>(y, 1, penalties);
      alongRow<Accumulation::kAdd>(y, -1, penalties);
    }
  }

  void alongColumns(const cv::Range& columns) const {
    PenaltyRow penalties(view_, columns, range_, costs_.width(), vertical_);
    alongColumns<Accumulation::kAdd>(columns, 1, penalties);
    alongColumns<Accumulation::kAddAndAverage>(columns, -1, penalties);
  }

 private:
  /// `step` is 1 for the path from the left, −1 for the one from the right.
  template <Accumulation accumulation>
  void alongRow(int y, int step, PenaltyRow& penalties) const {
    const int neighbour = step > 0 ? 0 : 1;  // an edge is stored at the right one of two pixels
    penalties.fill(reference_.horizontal.ptr<std::uint8_t>(y) + neighbour,
                   other_.horizontal.ptr<std::uint8_t>(y) + neighbour);
    PathFront front(1, range_.count);
    const int first = step > 0 ? 0 : costs_.width() - 1;
    for (int i = 0; i < costs_.width(); ++i) {
      const int x = first + i * step;
      front.extend<accumulation>(0, costs_.pixel(y, x), penalties.p1(x), penalties.p2(x),
                                 mean_.pixel(y, x));
      front.advance();
    }
  }

  /// `step` is 1 for the paths from above, −1 for those from below.
  template <Accumulation accumulation>
  void alongColumns(const cv::Range& columns, int step, PenaltyRow& penalties) const {
    const int neighbour = step > 0 ? 0 : 1;  // an edge is stored at the lower one of two pixels
    PathFront front(columns.size(), range_.count);
    const int first = step > 0 ? 0 : costs_.height() - 1;
    for (int i = 0; i < costs_.height(); ++i) {
      const int y = first + i * step;
      penalties.fill(reference_.vertical.ptr<std::uint8_t>(y + neighbour),
                     other_.vertical.ptr<std::uint8_t>(y + neighbour));
      for (int x = columns.start; x < columns.end; ++x) {
        front.extend<accumulation>(x - columns.start, costs_.pixel(y, x), penalties.p1(x),
                                   penalties.p2(x), mean_.pixel(y, x));
      }
      front.advance();
    }
  }

  const OptimizedVolume& costs_;
  const View view_;
  const DisparityRange range_;
  const EdgeMaps reference_;
  const EdgeMaps other_;
  const Penalties horizontal_;
  const Penalties vertical_;
  OptimizedVolume& mean_;
};

}  // namespace

void semiGlobalMatching(const OptimizedVolume& costs, const EdgeImages& images, View view,
                        const DisparityRange& range, const SgmOptions& options,
                        OptimizedVolume& mean) {
  const cv::Size size(costs.width(), costs.height());
  CV_Assert(images.reference.type() == CV_8UC1 && images.reference.size() == size);
  CV_Assert(images.other.type() == CV_8UC1 && images.other.size() == size);
  CV_Assert(costs.disparities() == range.count && &costs != &mean);
  checkOptions(options);

  mean.resize(costs.height(), costs.width(), costs.disparities());
  const Sweeps sweeps(costs, images, view, range, options, mean);
  tbb::parallel_for(tbb::blocked_range<int>(0, size.height), [&](const auto& rows) {
    sweeps.alongRows({rows.begin(), rows.end()});
  });
  const int blocks = (size.width + kColumnsPerBlock - 1) / kColumnsPerBlock;
  tbb::parallel_for(0, blocks, [&](int block) {
    const int first = block * kColumnsPerBlock;
    sweeps.alongColumns({first, std::min(first + kColumnsPerBlock, size.width)});
  });
}

int sgmCostBound(const SgmOptions& options) {
  const double bound = 255.0 + options.iterations * std::round(255.0 * options.p2);
  return static_cast<int>(std::min<double>(bound, std::numeric_limits<int>::max()));
}

}  // namespace cbmv
