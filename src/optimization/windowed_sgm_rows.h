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

/// At least the lanes of the widest vector.
constexpr int kMostLanes = 32;

/// Consecutive disparities of a tile, and the vector lanes that they are put in.
struct LaneRun {
  int lane;
  int index;
  int length;
};

/// A tile with a lane for each hypothesis, in ascending order, with gaps between the runs.
struct LaneTile {
  const LaneRun* runs;  ///< one of length 0 behind the last one
  int lanes;
  int padded_lanes;  ///< whole vectors
  int stride;        ///< of the pixels, in memory; whole vectors, too
  /// [column][lane] of matching costs with edges (see MatchingLanes), then one row more:
  /// kNoHypothesis in the lanes of no hypothesis, 0 in the others.
  std::uint16_t* matching;
  std::uint16_t* costs;  ///< [column][lane] of the path costs of one path, then of both
};

/// Memory of a row, laid out by lanes.
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

  /// Of a pixel, [lane]; at least two elements on either side are kNoPath.
  std::uint16_t* costs(int pixel) { return costs_[pixel % 2].data() + kMostLanes; }
  /// Of the last pixel of a tile, [index]; kNoPath where there is no hypothesis.
  std::uint16_t* previous() { return previous_.data() + kMostLanes; }
  /// At the first pixel of a tile, [lane]: see pathCosts.
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
  /// Paths wait for their previous pixel all the time; this many rows fill the gaps.
  static constexpr int kRowsAtOnce = 2;

  struct Memory {
    std::array<LaneRow, kRowsAtOnce> rows;
    std::array<RowFront, 2 * kRowsAtOnce> fronts;
  };

  void resize(const PathSetup& setup);

  /// Sets the sums of at most kRowsAtOnce rows.
  template <typename Cost>
  void run(const WindowedVolume<Cost>& costs, const cv::Range& rows, WindowedOptimizedVolume& sums);

 private:
  const PathSetup* setup_ = nullptr;
  Memory memory_;
};

}  // namespace cbmv
