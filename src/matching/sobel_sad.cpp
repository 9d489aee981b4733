#include "cbmv_stereo/matching/sobel_sad.h"

#include <algorithm>
#include <array>

#include <opencv2/imgproc.hpp>

#include "cbmv_stereo/matching/padded_image.h"

namespace cbmv {
namespace {

constexpr int kRadius = SobelSadMatcher::kWindowPx / 2;
using WindowRows = std::array<const std::int16_t*, SobelSadMatcher::kWindowPx>;

WindowRows windowRows(const cv::Mat& padded, int y) {
  WindowRows rows{};
  for (int r = 0; r < SobelSadMatcher::kWindowPx; ++r) {
    rows[r] = paddedRow<std::int16_t>(padded, y + r - kRadius);
  }
  return rows;
}

}  // namespace

void SobelSadMatcher::prepare(const cv::Mat& padded_left, const cv::Mat& padded_right) {
  cv::Sobel(padded_left, left_responses_, CV_16S, 1, 0, 3, 1, 0, cv::BORDER_REPLICATE);
  cv::Sobel(padded_right, right_responses_, CV_16S, 1, 0, 3, 1, 0, cv::BORDER_REPLICATE);
}

void SobelSadMatcher::computeRow(int y, const DisparityRange& range, Scratch& scratch,
                                 CostRow& costs) const {
  const int width = left_responses_.cols - 2 * kMatchingBorderPx;
  costs.resize(width, range.count);
  scratch.column_sums.resize(width + 2 * kRadius);
  const WindowRows left = windowRows(left_responses_, y);
  const WindowRows right = windowRows(right_responses_, y);
  for (int i = 0; i < range.count; ++i) {
    const int d = range.min + i;
    const ColumnSpan span = matchedColumns(width, d);
    std::uint16_t* column_sums = scratch.column_sums.data() + kRadius;
    for (int x = span.begin - kRadius; x < span.end + kRadius; ++x) {
      std::uint16_t sum = 0;
      for (int r = 0; r < kWindowPx; ++r) {
        const auto difference = static_cast<std::int16_t>(left[r][x] - right[r][x - d]);
        sum = static_cast<std::uint16_t>(
            sum + std::max(difference, static_cast<std::int16_t>(-difference)));
      }
      column_sums[x] = sum;
    }
    float* line = costs.line(i);
    for (int x = span.begin; x < span.end; ++x) {
      const auto sum =
          static_cast<std::uint16_t>(column_sums[x - 2] + column_sums[x - 1] + column_sums[x] +
                                     column_sums[x + 1] + column_sums[x + 2]);
      line[x] = static_cast<float>(sum);
    }
  }
}

}  // namespace cbmv
