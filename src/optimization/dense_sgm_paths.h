#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include <opencv2/core.hpp>

#include "base/volume.h"
#include "optimization/edge_maps.h"
#include "optimization/matching_row.h"
#include "optimization/path_rows.h"
#include "optimization/sgm_kernels.h"
#include "optimization/sgm_penalties.h"
#include "optimization/surface_prior.h"

#include "cbmv_stereo/disparity_range.h"

// The paths of SGM over a volume: penalties, memory and steps.

namespace cbmv {

/// Common data of all paths, except the costs.
struct DensePathSetup {
  View view = View::kLeft;
  DisparityRange range;
  int width = 0;
  int height = 0;
  SgmPenalties horizontal{};
  SgmPenalties vertical{};
  EdgeMaps reference;
  EdgeMaps other;
  cv::Mat surface;  // with a border of one pixel without a surface; empty: no surface

  /// The surface at the pixels (x + dx, y). nullptr if there is none.
  const std::int16_t* surfaceRow(int y, int dx = 0) const {
    return surface.empty() ? nullptr : surface.ptr<std::int16_t>(y + 1) + 1 + dx;
  }
};

/// Two neighboring rows or columns of pixels; the second is the next on the path. Pointers are to
/// the first column of the image.
struct PathStep {
  const std::uint8_t* reference_edges;
  const std::uint8_t* other_edges;
  const std::int16_t* surface;  // nullptr: unknown
  const std::int16_t* previous_surface;
};

/// Penalties for all hypotheses of the pixels of a row or a part of it.
class PenaltyRow {
 public:
  void resize(const DensePathSetup& setup, const cv::Range& columns,
              const SgmPenalties& penalties) {
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
  using Table = std::array<std::vector<PathCost>, 2>;  // indexed by the edge in the reference image

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

/// Memory of neighboring paths of one direction.
class PathFront {
 public:
  void resize(int paths, int disparities) {
    stride_ = (disparities + 1 + kLine) / kLine * kLine;
    disparities_ = disparities;
    lowest_.resize(paths);
    previous_.assign(kLine + paths * stride_ + kLine, kGuard);
    current_.assign(previous_.size(), kGuard);
  }

  /// Starts new paths: sets all costs to zero, so that the first step gives L_r = C.
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

  /// Call after all paths were extended.
  void advance() { previous_.swap(current_); }

 private:
  /// Elements per cache line. The costs of a path start at a cache line.
  static constexpr std::ptrdiff_t kLine = 64 / sizeof(PathCost);
  using Costs = std::vector<PathCost, CacheLineAllocator<PathCost>>;

  std::ptrdiff_t stride_ = 0;  // leaves at least two guards after the costs
  int disparities_ = 0;
  std::vector<PathCost> lowest_;
  Costs previous_;
  Costs current_;
};

template <typename Cost>
PathPixels<Cost> pixelsOf(const Volume<Cost>& costs, int y, const cv::Range& columns,
                          AggregatedVolume& sums) {
  return {costs.pixel(y, columns.start), sums.pixel(y, columns.start), columns.size(),
          costs.disparities()};
}

/// The paths along rows.
class DenseRowPaths {
 public:
  void resize(const DensePathSetup& setup) {
    setup_ = &setup;
    columns_ = cv::Range(0, setup.width);
    from_left_.resize(setup, columns_, setup.horizontal);
    from_right_.resize(setup, columns_, setup.horizontal);
    front_.resize(2, setup.range.count);
  }

  /// Sets the sums of a row.
  template <typename Cost>
  void run(const Volume<Cost>& costs, int y, AggregatedVolume& sums) {
    // An edge is stored at the right one of its two pixels.
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
  const DensePathSetup* setup_ = nullptr;
  cv::Range columns_;
  PenaltyRow from_left_;
  PenaltyRow from_right_;
  PathFront front_;
};

/// The paths along some neighboring columns, first from above, then from below.
class DenseColumnPaths {
 public:
  void resize(const DensePathSetup& setup, const cv::Range& columns) {
    setup_ = &setup;
    columns_ = columns;
    penalties_.resize(setup, columns, setup.vertical);
    front_.resize(columns.size(), setup.range.count);
    front_.reset();
  }

  /// Adds the paths from above to the sums of the next rows.
  template <typename Cost>
  void runDown(const Volume<Cost>& costs, const cv::Range& rows, AggregatedVolume& sums) {
    for (int y = rows.start; y < rows.end; ++y) {
      addColumns(pixelsOf(costs, y, columns_, sums), fillPenalties(y, y - 1), front_.ends());
      front_.advance();
    }
  }

  /// Adds the paths from below to the sums of all rows and converts the sums to means.
  template <typename Cost>
  void runUp(const Volume<Cost>& costs, AggregatedVolume& sums) {
    front_.reset();
    for (int y = costs.height() - 1; y >= 0; --y) {
      averageColumns(pixelsOf(costs, y, columns_, sums), fillPenalties(y, y + 1), front_.ends());
      front_.advance();
    }
  }

 private:
  /// Penalties of the step from row `previous` to row `y`. An edge is stored at the lower of the
  /// two rows.
  RowPenalties fillPenalties(int y, int previous) {
    const int lower = std::max(y, previous);
    return penalties_.fill({setup_->reference.vertical.ptr<std::uint8_t>(lower),
                            setup_->other.vertical.ptr<std::uint8_t>(lower), setup_->surfaceRow(y),
                            setup_->surfaceRow(previous)});
  }

  const DensePathSetup* setup_ = nullptr;
  cv::Range columns_;
  PenaltyRow penalties_;
  PathFront front_;
};

}  // namespace cbmv
