#include "refinement/subpixel.h"

#include <cmath>
#include <cstdint>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

namespace cbmv {
namespace {

/// Position of the minimum of the parabola through the costs at −1, 0 and 1. 0 if they have no
/// strict minimum at 0.
float parabolaMinimum(int before, int here, int after) {
  const int curvature = before - 2 * here + after;
  if (here > before || here > after || curvature == 0) {
    return 0;
  }
  return static_cast<float>(before - after) / static_cast<float>(2 * curvature);
}

/// Returns whether the column is inside of an image of this width.
bool isColumn(int x, int width) { return x >= 0 && x < width; }

}  // namespace

void refineSubpixel(const AggregatedVolume& costs, View view, const DisparityRange& range,
                    cv::Mat& disparity) {
  CV_Assert(disparity.type() == CV_32FC1 && costs.disparities() == range.count);
  CV_Assert(disparity.size() == cv::Size(costs.width(), costs.height()));
  const int width = costs.width();
  tbb::parallel_for(tbb::blocked_range<int>(0, costs.height()), [&](const auto& rows) {
    for (int y = rows.begin(); y != rows.end(); ++y) {
      auto* out = disparity.ptr<float>(y);
      for (int x = 0; x < width; ++x) {
        // An invalid pixel is below the range.
        const int d = static_cast<int>(out[x]);
        const bool refinable = static_cast<float>(d) == out[x] && d > range.min &&
                               d < range.max() && isColumn(matchingColumn(view, x, d - 1), width) &&
                               isColumn(matchingColumn(view, x, d + 1), width);
        if (refinable) {
          const std::uint16_t* here = costs.pixel(y, x) + (d - range.min);
          out[x] += parabolaMinimum(here[-1], here[0], here[1]);
        }
      }
    }
  });
}

}  // namespace cbmv
