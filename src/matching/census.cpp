#include "cbmv_stereo/matching/census.h"

#include "cbmv_stereo/matching/padded_image.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "matching/census.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

#include "simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace cbmv {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Bytes = hn::CappedTag<std::uint8_t, 64>;

/// Hamming distances of the columns `span` of the left image and those d further left in the right
/// one. Byte k of a column lies `stride` behind byte k − 1.
void hammingDistances(const std::uint8_t* left, const std::uint8_t* right, int stride, int d,
                      const ColumnSpan& span, std::uint8_t* line) {
  forLanes(Bytes(), span.begin, span.end, [=](auto tag, int x, int) HWY_ATTR {
    auto distance = hn::Zero(tag);
    for (int k = 0; k < CensusMatcher::kBytes; ++k) {
      const auto difference = hn::Xor(hn::LoadU(tag, left + k * stride + x),
                                      hn::LoadU(tag, right + k * stride + x - d));
      distance = hn::Add(distance, hn::PopulationCount(difference));
    }
    hn::StoreU(distance, tag, line + x);
  });
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace cbmv
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cbmv {
namespace {

HWY_EXPORT(hammingDistances);

}  // namespace

void CensusMatcher::prepare(const cv::Mat& padded_left, const cv::Mat& padded_right) {
  const cv::Size window(kWindowPx, kWindowPx);
  width_ = padded_left.cols - 2 * kMatchingBorderPx;
  left_.compute(padded_left, window);
  right_.compute(padded_right, window);
}

void CensusMatcher::computeRow(int y, const DisparityRange& range, CostRow<std::uint8_t>& costs,
                               const RowSpans* spans) const {
  costs.resize(width_, range.count);
  for (int i = 0; i < range.count; ++i) {
    const int d = range.min + i;
    forSpans(spans, width_, range, i, [&](const ColumnSpan& span) {
      HWY_DYNAMIC_DISPATCH(hammingDistances)
      (left_.row(y), right_.row(y), width_, d, span, costs.line(i));
    });
  }
}

}  // namespace cbmv
#endif  // HWY_ONCE
