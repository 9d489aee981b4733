#include "cbmv_stereo/matching/zero_mean_sad.h"

#include <algorithm>
#include <cstddef>

#include <opencv2/imgproc.hpp>

#include "cbmv_stereo/matching/padded_image.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "matching/zero_mean_sad.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

#include "simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace cbmv {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Words = hn::CappedTag<std::int16_t, 32>;

/// Σ |difference − mean difference| over the windows of the columns `span`. The differences of
/// pixels, column 0 of row r at differences + r · stride, are computed from two columns before to
/// two behind.
void sumDeviations(const ZeroMeanSadMatcher::Windows& left,
                   const ZeroMeanSadMatcher::Windows& right, int d, const ColumnSpan& span,
                   int stride, std::int16_t* differences, std::uint16_t* line) {
  constexpr int kRadius = ZeroMeanSadMatcher::kWindowPx / 2;
  const ZeroMeanSadMatcher::Windows l = left;
  const ZeroMeanSadMatcher::Windows r = right;
  for (int row = 0; row < ZeroMeanSadMatcher::kWindowPx; ++row) {
    forLanes(Words(), span.begin - kRadius, span.end + kRadius, [=](auto tag, int x, int) HWY_ATTR {
      hn::StoreU(hn::Sub(hn::LoadU(tag, l.rows[row] + x), hn::LoadU(tag, r.rows[row] + x - d)), tag,
                 differences + row * stride + x);
    });
  }
  forLanes(Words(), span.begin, span.end, [=](auto tag, int x, int) HWY_ATTR {
    const auto mean_difference =
        hn::Sub(hn::LoadU(tag, l.means + x), hn::LoadU(tag, r.means + x - d));
    auto sum = hn::Zero(tag);
    for (int row = 0; row < ZeroMeanSadMatcher::kWindowPx; ++row) {
      for (int k = -kRadius; k <= kRadius; ++k) {
        const auto difference = hn::LoadU(tag, differences + row * stride + x + k);
        sum = hn::Add(sum, hn::Abs(hn::Sub(difference, mean_difference)));
      }
    }
    const hn::RebindToUnsigned<decltype(tag)> unsigned_tag;
    hn::StoreU(hn::BitCast(unsigned_tag, sum), unsigned_tag, line + x);
  });
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace cbmv
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cbmv {
namespace {

HWY_EXPORT(sumDeviations);

/// Mean of every window, without the padding.
void windowMeans(const cv::Mat& padded, cv::Mat& means) {
  constexpr int kPixels = ZeroMeanSadMatcher::kWindowPx * ZeroMeanSadMatcher::kWindowPx;
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
      return static_cast<std::int16_t>((ZeroMeanSadMatcher::kUnitsPerGrey * s + kPixels / 2) /
                                       kPixels);
    });
  }
}

}  // namespace

ZeroMeanSadMatcher::Windows ZeroMeanSadMatcher::WindowStatistics::row(int y) const {
  Windows windows{{}, means.ptr<std::int16_t>(y)};
  for (int r = 0; r < kWindowPx; ++r) {
    windows.rows[r] = paddedRow<std::int16_t>(padded, y + r - kWindowPx / 2);
  }
  return windows;
}

void ZeroMeanSadMatcher::prepareImage(const cv::Mat& padded, WindowStatistics& statistics) {
  padded.convertTo(statistics.padded, CV_16S, kUnitsPerGrey);
  windowMeans(padded, statistics.means);
}

void ZeroMeanSadMatcher::prepare(const cv::Mat& padded_left, const cv::Mat& padded_right) {
  prepareImage(padded_left, left_);
  prepareImage(padded_right, right_);
}

void ZeroMeanSadMatcher::computeRow(int y, const DisparityRange& range, Scratch& scratch,
                                    CostRow<std::uint16_t>& costs) const {
  const int width = left_.means.cols;
  const int stride = width + kWindowPx - 1;
  costs.resize(width, range.count);
  scratch.differences.resize(static_cast<std::size_t>(stride) * kWindowPx);
  const Windows left = left_.row(y);
  const Windows right = right_.row(y);
  for (int i = 0; i < range.count; ++i) {
    const int d = range.min + i;
    HWY_DYNAMIC_DISPATCH(sumDeviations)
    (left, right, d, matchedColumns(width, d), stride, scratch.differences.data() + kWindowPx / 2,
     costs.line(i));
  }
}

}  // namespace cbmv
#endif  // HWY_ONCE
