#include "matching/zero_mean_sad.h"

#include <algorithm>
#include <numeric>

#include <tbb/parallel_for.h>

#include "matching/padded_image.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "matching/zero_mean_sad.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

#include "base/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace cbmv {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Words = hn::CappedTag<std::int16_t, 32>;

/// Σ |difference − mean difference| over the windows of the columns `span`. `differences` is
/// scratch memory for the differences of pixels: column 0 of row r is at differences + r · stride.
/// They are computed from two columns before `span` to two columns after it.
HWY_INLINE void sumDeviationsOfRun(const ZeroMeanSadMatcher::Windows& left,
                                   const ZeroMeanSadMatcher::Windows& right, int d,
                                   const ColumnSpan& span, int stride, std::int16_t* differences,
                                   std::uint16_t* line) {
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

void sumDeviations(const ZeroMeanSadMatcher::Windows& left,
                   const ZeroMeanSadMatcher::Windows& right, const RowEntries& entries, int stride,
                   std::int16_t* differences, std::uint16_t* costs) {
  for (const RowEntries::Run& run : entries.runs()) {
    sumDeviationsOfRun(left, right, run.d, run.span, stride, differences, costs + run.offset);
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace cbmv
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cbmv {
namespace {

HWY_EXPORT(sumDeviations);

constexpr int kWindow = ZeroMeanSadMatcher::kWindowPx;
constexpr int kPixels = kWindow * kWindow;
constexpr int kBlock = 512;  // columns whose sums fit on the stack

/// Means of the windows around the pixels of row y, in blocks.
void meansOfRow(const cv::Mat& padded, int y, int width, std::int16_t* means) {
  std::array<int, kBlock + kWindow - 1> columns{};
  for (int first = 0; first < width; first += kBlock) {
    const int count = std::min(kBlock, width - first);
    columns.fill(0);
    for (int row = y - kWindow / 2; row <= y + kWindow / 2; ++row) {
      const auto* pixels = paddedRow<std::uint8_t>(padded, row) + first - kWindow / 2;
      for (int i = 0; i < count + kWindow - 1; ++i) {
        columns[i] += pixels[i];
      }
    }
    for (int i = 0; i < count; ++i) {
      const int sum = std::accumulate(&columns[i], &columns[i] + kWindow, 0);
      means[first + i] = static_cast<std::int16_t>(
          (ZeroMeanSadMatcher::kUnitsPerGray * sum + kPixels / 2) / kPixels);
    }
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
  const int height = padded.rows - 2 * kMatchingBorderPx;
  const int width = padded.cols - 2 * kMatchingBorderPx;
  padded.convertTo(statistics.padded, CV_16S, kUnitsPerGray);
  statistics.means.create(height, width, CV_16SC1);
  tbb::parallel_for(0, height, [&](int y) {
    meansOfRow(padded, y, width, statistics.means.ptr<std::int16_t>(y));
  });
}

void ZeroMeanSadMatcher::prepare(const cv::Mat& padded_left, const cv::Mat& padded_right) {
  prepareImage(padded_left, left_);
  prepareImage(padded_right, right_);
}

void ZeroMeanSadMatcher::computeRow(int y, const RowEntries& entries, Scratch& scratch,
                                    CostRow<std::uint16_t>& costs) const {
  const int width = left_.means.cols;
  costs.resize(entries.count());
  scratch.resize(width);
  HWY_DYNAMIC_DISPATCH(sumDeviations)
  (left_.row(y), right_.row(y), entries, width + kWindowPx - 1,
   scratch.differences.data() + kWindowPx / 2, costs.entry(0));
}

}  // namespace cbmv
#endif  // HWY_ONCE
