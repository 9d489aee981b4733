#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

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
struct RowBuffer {
  using Costs = std::vector<std::uint16_t, CacheLineAllocator<std::uint16_t>>;

  void resize(int disparities);
  std::uint16_t* pixel(int column) { return pixels.data() + kGap + column * stride; }

  /// At least the lanes of the widest vector.
  static constexpr std::ptrdiff_t kGap = 32;

  std::vector<LaneRun> runs;
  std::vector<LaneRun> previous_runs;
  std::size_t run_count = 0;
  std::size_t previous_run_count = 0;
  Costs entries;  ///< [lane][column]
  Costs pixels;   ///< [column][lane]
  std::ptrdiff_t stride = 0;
  Costs previous;  ///< [index] of the last pixel of the tile before; else kNoPath
  Costs along;     ///< of PreviousCosts, [lane], at a tile's first pixel
  Costs beside;
};

/// The paths along a row.
class RowPaths {
 public:
  void resize(const PathSetup& setup);

  /// Sets the sums of a row.
  template <typename Cost>
  void run(const WindowedVolume<Cost>& costs, int y, WindowedOptimizedVolume& sums);

 private:
  const PathSetup* setup_ = nullptr;
  std::array<RowBuffer, 2> buffers_;
};

}  // namespace cbmv
