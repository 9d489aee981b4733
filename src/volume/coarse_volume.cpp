#include "volume/coarse_volume.h"

#include <algorithm>
#include <cstdint>

#include <tbb/parallel_for.h>

namespace cbmv {
namespace {

int floorHalf(int value) { return (value - (value & 1)) / 2; }

/// Four neighboring pixels, as pointers to their costs.
struct Square {
  int mean(int i) const { return (a[i] + b[i] + c[i] + d[i] + 2) / 4; }

  const std::uint8_t* a;
  const std::uint8_t* b;
  const std::uint8_t* c;
  const std::uint8_t* d;
};

void halvePixel(const Square& square, int disparities, bool first_alone, std::uint8_t* half) {
  int i = 0;
  if (first_alone) {
    *half++ = static_cast<std::uint8_t>(square.mean(i++));
  }
  for (; i + 1 < disparities; i += 2) {
    *half++ = static_cast<std::uint8_t>(std::min(square.mean(i), square.mean(i + 1)));
  }
  if (i < disparities) {
    *half = static_cast<std::uint8_t>(square.mean(i));
  }
}

}  // namespace

DisparityRange halveRange(const DisparityRange& range) {
  const int lowest = floorHalf(range.min);
  return {lowest, floorHalf(range.max()) - lowest + 1};
}

void halveImage(const cv::Mat& gray, cv::Mat& half) {
  half.create(gray.rows / 2, gray.cols / 2, CV_8UC1);
  tbb::parallel_for(0, half.rows, [&](int y) {
    const auto* upper = gray.ptr<std::uint8_t>(2 * y);
    const auto* lower = gray.ptr<std::uint8_t>(2 * y + 1);
    auto* out = half.ptr<std::uint8_t>(y);
    for (int x = 0; x < half.cols; ++x) {
      const Square square{upper + 2 * x, upper + 2 * x + 1, lower + 2 * x, lower + 2 * x + 1};
      out[x] = static_cast<std::uint8_t>(square.mean(0));
    }
  });
}

void halveVolume(const MatchingVolume& costs, const DisparityRange& range, MatchingVolume& half) {
  const bool first_alone = range.min % 2 != 0;
  half.resize(costs.height() / 2, costs.width() / 2, halveRange(range).count);
  tbb::parallel_for(0, half.height(), [&](int y) {
    for (int x = 0; x < half.width(); ++x) {
      const Square square{costs.pixel(2 * y, 2 * x), costs.pixel(2 * y, 2 * x + 1),
                          costs.pixel(2 * y + 1, 2 * x), costs.pixel(2 * y + 1, 2 * x + 1)};
      halvePixel(square, costs.disparities(), first_alone, half.pixel(y, x));
    }
  });
}

}  // namespace cbmv
