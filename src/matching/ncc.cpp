#include "cbmv_stereo/matching/ncc.h"

#include <array>
#include <cmath>
#include <cstdint>

#include <tbb/parallel_for.h>

#include "cbmv_stereo/matching/padded_image.h"

namespace cbmv {
namespace {

constexpr int kRadius = NccMatcher::kWindowPx / 2;
constexpr int kPixels = NccMatcher::kWindowPx * NccMatcher::kWindowPx;
using WindowRows = std::array<const std::uint8_t*, NccMatcher::kWindowPx>;

WindowRows windowRows(const cv::Mat& padded, int y) {
  return {paddedRow<std::uint8_t>(padded, y - 1), paddedRow<std::uint8_t>(padded, y),
          paddedRow<std::uint8_t>(padded, y + 1)};
}

/// Sum over the window of the products of both images' pixels.
inline std::int32_t sumOfProducts(const WindowRows& left, const WindowRows& right, int x, int d) {
  std::int32_t sum = 0;
  for (int r = 0; r < NccMatcher::kWindowPx; ++r) {
    for (int dx = -kRadius; dx <= kRadius; ++dx) {
      sum += left[r][x + dx] * right[r][x + dx - d];
    }
  }
  return sum;
}

}  // namespace

void NccMatcher::prepareImage(const cv::Mat& padded, WindowStatistics& statistics) {
  statistics.padded = padded;
  const int height = padded.rows - 2 * kMatchingBorderPx;
  const int width = padded.cols - 2 * kMatchingBorderPx;
  statistics.sums.create(height, width, CV_32SC1);
  statistics.inverse_deviations.create(height, width, CV_32FC1);
  tbb::parallel_for(0, height, [&](int y) {
    const WindowRows rows = windowRows(padded, y);
    auto* sums = statistics.sums.ptr<std::int32_t>(y);
    auto* inverse_deviations = statistics.inverse_deviations.ptr<float>(y);
    for (int x = 0; x < width; ++x) {
      std::int32_t sum = 0;
      for (const std::uint8_t* row : rows) {
        sum += row[x - 1] + row[x] + row[x + 1];
      }
      const std::int32_t variance = kPixels * sumOfProducts(rows, rows, x, 0) - sum * sum;
      sums[x] = sum;
      inverse_deviations[x] = variance > 0 ? 1.0F / std::sqrt(static_cast<float>(variance)) : 0.0F;
    }
  });
}

void NccMatcher::prepare(const cv::Mat& padded_left, const cv::Mat& padded_right) {
  prepareImage(padded_left, left_);
  prepareImage(padded_right, right_);
}

void NccMatcher::computeRow(int y, const DisparityRange& range, CostRow& costs) const {
  const int width = left_.sums.cols;
  costs.resize(width, range.count);
  const WindowRows left_rows = windowRows(left_.padded, y);
  const WindowRows right_rows = windowRows(right_.padded, y);
  const auto* left_sums = left_.sums.ptr<std::int32_t>(y);
  const auto* right_sums = right_.sums.ptr<std::int32_t>(y);
  const auto* left_inverse = left_.inverse_deviations.ptr<float>(y);
  const auto* right_inverse = right_.inverse_deviations.ptr<float>(y);
  for (int i = 0; i < range.count; ++i) {
    const int d = range.min + i;
    const ColumnSpan span = matchedColumns(width, d);
    float* line = costs.line(i);
    for (int x = span.begin; x < span.end; ++x) {
      const std::int32_t covariance =
          kPixels * sumOfProducts(left_rows, right_rows, x, d) - left_sums[x] * right_sums[x - d];
      const float inverse = left_inverse[x] * right_inverse[x - d];
      line[x] = inverse > 0.0F ? -static_cast<float>(covariance) * inverse : 1.0F;
    }
  }
}

}  // namespace cbmv
