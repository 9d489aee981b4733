#include "selection/thin_pixels.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>

#include "selection/map_planes.h"

namespace cbmv {
namespace {

constexpr int kReachPx = 12;
constexpr int kFewestAlong = 8;
constexpr int kMostAcross = 4;

std::array<cv::Point, 4> directions() { return {{{1, 0}, {0, 1}, {1, 1}, {1, -1}}}; }

/// Pixels with about the same disparity on the line through a pixel, itself included.
int countOnLine(const cv::Mat& disparity, const cv::Point& pixel, const cv::Point& direction) {
  const cv::Rect image(0, 0, disparity.cols, disparity.rows);
  const int own = disparity.at<std::int16_t>(pixel);
  int count = 0;
  for (int step = -kReachPx; step <= kReachPx; ++step) {
    const cv::Point other = pixel + step * direction;
    if (image.contains(other) &&
        std::abs(disparity.at<std::int16_t>(other) - own) <= kPlaneUnitsPerPx) {
      ++count;
    }
  }
  return count;
}

}  // namespace

bool isThin(const cv::Mat& disparity, int y, int x) {
  int most = 0;
  int fewest = 2 * kReachPx + 1;
  for (const cv::Point& direction : directions()) {
    const int count = countOnLine(disparity, {x, y}, direction);
    most = std::max(most, count);
    fewest = std::min(fewest, count);
  }
  return most >= kFewestAlong && fewest <= kMostAcross;
}

}  // namespace cbmv
