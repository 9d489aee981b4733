#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

#include "base/search_space.h"
#include "base/volume.h"
#include "optimization/windowed_sgm_paths.h"

namespace cbmv {

/// At least the number of lanes of the widest vector.
constexpr int kMostLanes = 32;

/// Consecutive disparities of a tile, and their position in the vector lanes.
struct LaneRun {
  int lane;
  int index;
  int length;
};

/// A tile with one lane per hypothesis in ascending order, with gaps between the runs.
struct LaneTile {
  const LaneRun* runs;  ///< ends with a run of length 0
  int lanes;
  int padded_lanes;  ///< rounded up to whole vectors
  int stride;        ///< distance between pixels in memory; whole vectors
  /// [column][lane] of matching costs with edge bits (kLeftEdge, kRightEdge). One more row has
  /// kNoHypothesis in the lanes without a hypothesis and 0 in the others.
  std::uint16_t* matching;
  std::uint16_t* costs;  ///< [column][lane]: path costs of one path, then the sum of both
};

/// Memory of a row in the layout by lanes.
class LaneRow {
 public:
  void resize(const SearchSpace& space);

  std::vector<LaneTile> tiles;
  std::vector<LaneRun> runs;
  std::vector<std::uint16_t, CacheLineAllocator<std::uint16_t>> matching;
  std::vector<std::uint16_t, CacheLineAllocator<std::uint16_t>> costs;
};

/// Memory of a path along a row.
class RowFront {
 public:
  void resize(int disparities);

  /// Costs of a pixel, [lane]. At least two elements on either side are kNoPath.
  std::uint16_t* costs(int pixel) { return costs_[pixel % 2].data() + kMostLanes; }
  /// Costs of the last pixel of a tile, [index]. kNoPath where there is no hypothesis.
  std::uint16_t* previous() { return previous_.data() + kMostLanes; }
  /// Inputs of pathCosts at the first pixel of a tile, [lane].
  std::uint16_t* along() { return along_.data(); }
  std::uint16_t* beside() { return beside_.data(); }

 private:
  using Costs = std::vector<std::uint16_t, CacheLineAllocator<std::uint16_t>>;

  std::array<Costs, 2> costs_;
  Costs previous_;
  Costs along_;
  Costs beside_;
};

/// The paths along rows.
class RowPaths {
 public:
  /// Number of rows that are processed together, because each path has to wait for its previous
  /// pixel.
  static constexpr int kRowsAtOnce = 2;

  struct Memory {
    std::array<LaneRow, kRowsAtOnce> rows;
    std::array<RowFront, 2 * kRowsAtOnce> fronts;
  };

  void resize(const PathSetup& setup);

  /// Sets the sums of at most kRowsAtOnce rows.
  template <typename Cost>
  void run(const WindowedVolume<Cost>& costs, const cv::Range& rows,
           WindowedAggregatedVolume& sums);

 private:
  const PathSetup* setup_ = nullptr;
  Memory memory_;
};

}  // namespace cbmv
