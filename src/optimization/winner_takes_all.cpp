#include "cbmv_stereo/optimization/winner_takes_all.h"

#include <algorithm>
#include <cstdint>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "inside_disparities.h"

namespace cbmv {
namespace {

/// Index of the first smallest of `count` ≥ 1 costs. Two passes, since a minimum alone vectorises.
int cheapest(const std::uint16_t* costs, int count) {
  std::uint16_t lowest = costs[0];
  for (int i = 1; i < count; ++i) {
    lowest = std::min(lowest, costs[i]);
  }
  return static_cast<int>(std::find(costs, costs + count, lowest) - costs);
}

}  // namespace

void winnerTakesAll(const OptimizedVolume& costs, View view, const DisparityRange& range,
                    cv::Mat& disparity) {
  CV_Assert(costs.disparities() == range.count);
  disparity.create(costs.height(), costs.width(), CV_32FC1);
  tbb::parallel_for(tbb::blocked_range<int>(0, costs.height()), [&](const auto& rows) {
    for (int y = rows.begin(); y != rows.end(); ++y) {
      auto* out = disparity.ptr<float>(y);
      for (int x = 0; x < costs.width(); ++x) {
        const cv::Range inside = insideDisparities(view, range, x, costs.width());
        out[x] =
            inside.empty()
                ? range.invalid()
                : static_cast<float>(range.min + inside.start +
                                     cheapest(costs.pixel(y, x) + inside.start, inside.size()));
      }
    }
  });
}

}  // namespace cbmv
