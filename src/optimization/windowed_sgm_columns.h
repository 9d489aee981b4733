#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

#include "base/search_space.h"
#include "base/volume.h"
#include "optimization/windowed_sgm_paths.h"

namespace cbmv {

/// Path costs of the tiles of a block in two rows: the row that was added last, and the next row
/// while it is added. Dense layout [index][column of the tile]. kNoPath where a tile does not have
/// the disparity, and at the two indices before and after the range.
class ColumnFront {
 public:
  void resize(int tiles, int disparities);

  std::uint16_t* costs(int tile, int row) {
    return costs_.data() + ((row % 2) * tiles_ + tile) * stride_ + 2 * kTileColumns;
  }
  /// Lowest cost of each column of a tile in the row that was added last.
  std::uint16_t* lowest(int tile) { return lowest_.data() + tile * kTileColumns; }

 private:
  int tiles_ = 0;
  std::ptrdiff_t stride_ = 0;
  std::vector<std::uint16_t, CacheLineAllocator<std::uint16_t>> costs_;
  std::vector<std::uint16_t, CacheLineAllocator<std::uint16_t>> lowest_;
};

/// The paths along the columns of some adjacent tiles, first from above, then from below.
class ColumnPaths {
 public:
  void resize(const PathSetup& setup, const cv::Range& tiles);

  /// Adds the paths from above to the sums of the next rows.
  template <typename Cost>
  void runDown(const WindowedVolume<Cost>& costs, const cv::Range& rows,
               WindowedAggregatedVolume& sums);

  /// Adds the paths from below to the sums of all rows and converts the sums to means. Call after
  /// runDown() has processed all rows.
  template <typename Cost>
  void runUp(const WindowedVolume<Cost>& costs, WindowedAggregatedVolume& sums);

 private:
  const PathSetup* setup_ = nullptr;
  cv::Range tiles_;
  ColumnFront front_;
};

}  // namespace cbmv
