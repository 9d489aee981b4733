#include "cbmv_stereo/refinement/windowed_subpixel.h"

#include <algorithm>
#include <cstdint>

#include <tbb/parallel_for.h>

#include "parabola.h"

namespace cbmv {
namespace {

/// What is added to the winner d of a pixel.
float offsetOf(const SearchSpace& space, const WindowedOptimizedVolume& costs, int y, int x,
               int index) {
  const SearchSpace::Tile tile = space.tile(y, x / kTileColumns);
  const auto* end = tile.indices + tile.count;
  const auto* found = std::lower_bound(tile.indices, end, static_cast<std::int16_t>(index));
  const bool has_neighbours = found != tile.indices && end - found > 1 && found[0] == index &&
                              found[-1] == index - 1 && found[1] == index + 1;
  if (!has_neighbours) {
    return 0;
  }
  const std::uint16_t* here =
      costs.entry(tile.first_entry + static_cast<std::size_t>(found - tile.indices)) +
      x % kTileColumns;
  return parabolaMinimum(here[-kTileColumns], here[0], here[kTileColumns]);
}

}  // namespace

void refineWindowedSubpixel(const SearchSpace& space, const WindowedOptimizedVolume& costs,
                            View view, cv::Mat& disparity) {
  CV_Assert(disparity.type() == CV_32FC1);
  const int width = space.width();
  const DisparityRange& range = space.range();
  tbb::parallel_for(0, space.height(), [&](int y) {
    auto* out = disparity.ptr<float>(y);
    for (int x = 0; x < width; ++x) {
      // An invalid pixel lies below the range.
      const int d = static_cast<int>(out[x]);
      const bool refinable = static_cast<float>(d) == out[x] && d > range.min && d < range.max() &&
                             isColumn(matchingColumn(view, x, d - 1), width) &&
                             isColumn(matchingColumn(view, x, d + 1), width);
      if (refinable) {
        out[x] += offsetOf(space, costs, y, x, d - range.min);
      }
    }
  });
}

}  // namespace cbmv
