#include "optimization/edge_maps.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include <tbb/parallel_for.h>

namespace cbmv {
namespace {

/// Marks each of `count` pixels that differs from the pixel `distance` before it by at least
/// `lowest_step` gray levels.
void markSteps(const std::uint8_t* pixels, std::ptrdiff_t distance, int count, int lowest_step,
               std::uint8_t* edges) {
  const std::uint8_t* neighbors = pixels - distance;
  for (int x = 0; x < count; ++x) {
    const int step = std::abs(pixels[x] - neighbors[x]);
    edges[x] = static_cast<std::uint8_t>(step >= lowest_step ? 1 : 0);
  }
}

}  // namespace

int lowestStep(float threshold_gray) {
  return static_cast<int>(std::ceil(std::clamp(threshold_gray, 0.0F, 256.0F)));
}

void findEdges(const cv::Mat& gray, float threshold_gray, EdgeMaps& edges) {
  const cv::Size size(gray.cols + 1, gray.rows + 1);
  edges.horizontal.create(size, CV_8UC1);
  edges.vertical.create(size, CV_8UC1);
  const int lowest_step = lowestStep(threshold_gray);
  const auto stride = static_cast<std::ptrdiff_t>(gray.step1());
  tbb::parallel_for(0, size.height, [&](int y) {
    auto* horizontal = edges.horizontal.ptr<std::uint8_t>(y);
    auto* vertical = edges.vertical.ptr<std::uint8_t>(y);
    std::fill_n(horizontal, size.width, std::uint8_t{0});
    std::fill_n(vertical, size.width, std::uint8_t{0});
    if (y < gray.rows) {
      const auto* pixels = gray.ptr<std::uint8_t>(y);
      markSteps(pixels + 1, 1, gray.cols - 1, lowest_step, horizontal + 1);
      if (y > 0) {
        markSteps(pixels, stride, gray.cols, lowest_step, vertical);
      }
    }
  });
}

}  // namespace cbmv
