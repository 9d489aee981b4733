#include "cbmv_stereo/matching/zero_mean_sad.h"

#include <algorithm>

#include <opencv2/imgproc.hpp>

#include "cbmv_stereo/matching/padded_image.h"

namespace cbmv {
namespace {

constexpr int kRadius = ZeroMeanSadMatcher::kWindowPx / 2;
constexpr int kPixels = ZeroMeanSadMatcher::kWindowPx * ZeroMeanSadMatcher::kWindowPx;
constexpr int kUnitsPerGrey = 4;

/// Mean of every window, in units of 1 / kUnitsPerGrey, without the padding.
void windowMeans(const cv::Mat& padded, cv::Mat& means) {
  cv::Mat sums;
  cv::boxFilter(padded, sums, CV_32S,
                {ZeroMeanSadMatcher::kWindowPx, ZeroMeanSadMatcher::kWindowPx}, {-1, -1}, false);
  const cv::Rect inside(kMatchingBorderPx, kMatchingBorderPx, padded.cols - 2 * kMatchingBorderPx,
                        padded.rows - 2 * kMatchingBorderPx);
  sums = sums(inside);
  means.create(inside.size(), CV_16SC1);
  for (int y = 0; y < means.rows; ++y) {
    const auto* sum = sums.ptr<std::int32_t>(y);
    std::transform(sum, sum + means.cols, means.ptr<std::int16_t>(y), [](std::int32_t s) {
      return static_cast<std::int16_t>((kUnitsPerGrey * s + kPixels / 2) / kPixels);
    });
  }
}

}  // namespace

void ZeroMeanSadMatcher::prepare(const cv::Mat& padded_left, const cv::Mat& padded_right) {
  padded_left_ = padded_left;
  padded_right_ = padded_right;
  windowMeans(padded_left, left_means_);
  windowMeans(padded_right, right_means_);
}

void ZeroMeanSadMatcher::computeRow(int y, const DisparityRange& range, Scratch& scratch,
                                    CostRow& costs) const {
  const int width = left_means_.cols;
  const int stride = width + 2 * kRadius;
  costs.resize(width, range.count);
  scratch.differences.resize(static_cast<std::size_t>(stride) * kWindowPx);
  const auto* left_means = left_means_.ptr<std::int16_t>(y);
  const auto* right_means = right_means_.ptr<std::int16_t>(y);
  for (int i = 0; i < range.count; ++i) {
    const int d = range.min + i;
    const ColumnSpan span = matchedColumns(width, d);
    for (int r = 0; r < kWindowPx; ++r) {
      const auto* left = paddedRow<std::uint8_t>(padded_left_, y + r - kRadius);
      const auto* right = paddedRow<std::uint8_t>(padded_right_, y + r - kRadius);
      std::int16_t* difference = scratch.differences.data() + r * stride + kRadius;
      for (int x = span.begin - kRadius; x < span.end + kRadius; ++x) {
        difference[x] = static_cast<std::int16_t>(kUnitsPerGrey * (left[x] - right[x - d]));
      }
    }
    float* line = costs.line(i);
    const std::int16_t* differences = scratch.differences.data();
    for (int x = span.begin; x < span.end; ++x) {
      const auto mean_difference = static_cast<std::int16_t>(left_means[x] - right_means[x - d]);
      std::uint16_t sum = 0;
      for (int r = 0; r < kWindowPx; ++r) {
        for (int k = 0; k < kWindowPx; ++k) {
          const auto deviation =
              static_cast<std::int16_t>(differences[r * stride + x + k] - mean_difference);
          sum = static_cast<std::uint16_t>(
              sum + std::max(deviation, static_cast<std::int16_t>(-deviation)));
        }
      }
      line[x] = static_cast<float>(sum) * (1.0F / kUnitsPerGrey);
    }
  }
}

}  // namespace cbmv
