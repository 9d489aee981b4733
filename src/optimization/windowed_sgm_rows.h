#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

#include "optimization/windowed_sgm_paths.h"

#include "cbmv_stereo/volume/search_space.h"
#include "cbmv_stereo/volume/volume.h"

namespace cbmv {

/// Consecutive disparities of a tile, and the vector lanes that they are put in.
struct LaneRun {
  int lane;
  int index;
  int length;
};

/// Memory of a path along a row, for the tile under way. A tile's hypotheses have a lane each, in
/// ascending order, with gaps between the runs.
struct RowMemory {
  LaneRun* runs;  ///< one of length 0 behind the last one
  LaneRun* previous_runs;
  std::uint16_t* entries;  ///< [lane][column]
  std::uint16_t* pixels;   ///< [column][lane], whose rows are `stride` apart
  std::ptrdiff_t stride;
  std::uint16_t* blocked;   ///< [lane]: which have no hypothesis
  std::uint16_t* previous;  ///< [index]: the last pixel of the tile before; else kNoPath
  std::uint16_t* along;     ///< [lane]: at the tile's first pixel, see pathCosts
  std::uint16_t* beside;
};

class RowBuffer {
 public:
  void resize(int disparities);
  RowMemory memory();

  /// Elements before and behind the lanes of a pixel: at least those of the widest vector.
  static constexpr std::ptrdiff_t kGap = 32;

 private:
  using Costs = std::vector<std::uint16_t, CacheLineAllocator<std::uint16_t>>;

  /// The last one included.
  static std::size_t maxRuns(int disparities) { return (disparities + 1) / 2 + 1; }

  std::vector<LaneRun> runs_;  // of two tiles
  Costs entries_;
  Costs pixels_;
  std::ptrdiff_t stride_ = 0;
  Costs blocked_;
  Costs previous_;
  Costs along_;
  Costs beside_;
};

/// The paths along rows.
class RowPaths {
 public:
  /// Paths wait for their previous pixel all the time; this many rows fill the gaps.
  static constexpr int kRowsAtOnce = 2;

  void resize(const PathSetup& setup);

  /// Sets the sums of at most kRowsAtOnce rows.
  template <typename Cost>
  void run(const WindowedVolume<Cost>& costs, const cv::Range& rows, WindowedOptimizedVolume& sums);

 private:
  const PathSetup* setup_ = nullptr;
  std::array<RowBuffer, 2 * kRowsAtOnce> buffers_;
};

}  // namespace cbmv
