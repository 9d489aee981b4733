#include "cbmv_stereo/matching/ncc.h"

#include <algorithm>

#include <tbb/parallel_for.h>

#include "cbmv_stereo/matching/padded_image.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "matching/ncc.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

#include "simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace cbmv {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Floats = hn::CappedTag<float, 16>;

// All sums and products here are whole numbers below 2²⁴, exact in single precision: a fused
// multiply-add changes nothing.
constexpr float kPixels = NccMatcher::kWindowPx * NccMatcher::kWindowPx;

/// Sum of columns x − 1, x, x + 1.
template <class D, class V = hn::Vec<D>>
HWY_INLINE V sumOfThree(D tag, const float* columns) {
  return hn::Add(hn::Add(hn::LoadU(tag, columns - 1), hn::LoadU(tag, columns)),
                 hn::LoadU(tag, columns + 1));
}

/// Sums down the columns of the windows, from one column before `span` to one behind, of left ·
/// right pixels.
HWY_INLINE void sumProducts(const NccMatcher::Rows& left, const NccMatcher::Rows& right, int d,
                            const ColumnSpan& span, float* columns) {
  const NccMatcher::Rows l = left;
  const NccMatcher::Rows r = right;
  forLanes(Floats(), span.begin - 1, span.end + 1, [=](auto tag, int x, int) HWY_ATTR {
    auto sum = hn::Mul(hn::LoadU(tag, l[0] + x), hn::LoadU(tag, r[0] + x - d));
    sum = hn::MulAdd(hn::LoadU(tag, l[1] + x), hn::LoadU(tag, r[1] + x - d), sum);
    sum = hn::MulAdd(hn::LoadU(tag, l[2] + x), hn::LoadU(tag, r[2] + x - d), sum);
    hn::StoreU(sum, tag, columns + x);
  });
}

void sumWindows(const NccMatcher::Rows& rows, int width, float* columns, float* sums,
                float* inverse_deviations) {
  const NccMatcher::Rows r = rows;
  forLanes(Floats(), -1, width + 1, [=](auto tag, int x, int) HWY_ATTR {
    const auto sum = hn::Add(hn::Add(hn::LoadU(tag, r[0] + x), hn::LoadU(tag, r[1] + x)),
                             hn::LoadU(tag, r[2] + x));
    hn::StoreU(sum, tag, columns + x);
  });
  forLanes(Floats(), 0, width, [=](auto tag, int x, int) HWY_ATTR {
    hn::StoreU(sumOfThree(tag, columns + x), tag, sums + x);
  });
  const ColumnSpan span{0, width};
  sumProducts(rows, rows, 0, span, columns);
  forLanes(Floats(), 0, width, [=](auto tag, int x, int) HWY_ATTR {
    const auto sum = hn::LoadU(tag, sums + x);
    const auto variance =
        hn::Sub(hn::Mul(hn::Set(tag, kPixels), sumOfThree(tag, columns + x)), hn::Mul(sum, sum));
    const auto inverse = hn::Div(hn::Set(tag, 1.0F), hn::Sqrt(variance));
    hn::StoreU(hn::IfThenElseZero(hn::Gt(variance, hn::Zero(tag)), inverse), tag,
               inverse_deviations + x);
  });
}

HWY_INLINE void correlateRun(const NccMatcher::Windows& left, const NccMatcher::Windows& right,
                             int d, const ColumnSpan& span, float* columns, float* line) {
  sumProducts(left.rows, right.rows, d, span, columns);
  const NccMatcher::Windows l = left;
  const NccMatcher::Windows r = right;
  forLanes(Floats(), span.begin, span.end, [=](auto tag, int x, int) HWY_ATTR {
    const auto negative_covariance =
        hn::Sub(hn::Mul(hn::LoadU(tag, l.sums + x), hn::LoadU(tag, r.sums + x - d)),
                hn::Mul(hn::Set(tag, kPixels), sumOfThree(tag, columns + x)));
    const auto inverse = hn::Mul(hn::LoadU(tag, l.inverse_deviations + x),
                                 hn::LoadU(tag, r.inverse_deviations + x - d));
    const auto cost = hn::Mul(negative_covariance, inverse);
    const auto textured = hn::Gt(inverse, hn::Zero(tag));
    hn::StoreU(hn::IfThenElse(textured, cost, hn::Set(tag, 1.0F)), tag, line + x);
  });
}

void correlate(const NccMatcher::Windows& left, const NccMatcher::Windows& right,
               const RowEntries& entries, float* columns, float* costs) {
  for (const RowEntries::Run& run : entries.runs()) {
    correlateRun(left, right, run.d, run.span, columns, costs + run.offset);
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace cbmv
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cbmv {
namespace {

HWY_EXPORT(sumWindows);
HWY_EXPORT(correlate);

NccMatcher::Rows windowRows(const cv::Mat& padded, int y) {
  return {paddedRow<float>(padded, y - 1), paddedRow<float>(padded, y),
          paddedRow<float>(padded, y + 1)};
}

constexpr int kBlock = 512;  // columns whose sums fit the stack

/// Statistics of the windows of a row, block by block.
void sumWindowsOfRow(const NccMatcher::Rows& rows, int width, float* sums,
                     float* inverse_deviations) {
  std::array<float, kBlock + 2> columns{};
  for (int x = 0; x < width; x += kBlock) {
    HWY_DYNAMIC_DISPATCH(sumWindows)
    ({rows[0] + x, rows[1] + x, rows[2] + x}, std::min(kBlock, width - x), columns.data() + 1,
     sums + x, inverse_deviations + x);
  }
}

}  // namespace

NccMatcher::Windows NccMatcher::WindowStatistics::row(int y) const {
  return {windowRows(padded, y), sums.ptr<float>(y), inverse_deviations.ptr<float>(y)};
}

void NccMatcher::prepareImage(const cv::Mat& padded, WindowStatistics& statistics) {
  const int height = padded.rows - 2 * kMatchingBorderPx;
  const int width = padded.cols - 2 * kMatchingBorderPx;
  padded.convertTo(statistics.padded, CV_32F);
  statistics.sums.create(height, width, CV_32FC1);
  statistics.inverse_deviations.create(height, width, CV_32FC1);
  tbb::parallel_for(0, height, [&](int y) {
    sumWindowsOfRow(windowRows(statistics.padded, y), width, statistics.sums.ptr<float>(y),
                    statistics.inverse_deviations.ptr<float>(y));
  });
}

void NccMatcher::prepare(const cv::Mat& padded_left, const cv::Mat& padded_right) {
  prepareImage(padded_left, left_);
  prepareImage(padded_right, right_);
}

void NccMatcher::computeRow(int y, const RowEntries& entries, Scratch& scratch,
                            CostRow<float>& costs) const {
  costs.resize(entries.count());
  scratch.resize(left_.sums.cols);
  HWY_DYNAMIC_DISPATCH(correlate)
  (left_.row(y), right_.row(y), entries, scratch.column_sums.data() + 1, costs.entry(0));
}

}  // namespace cbmv
#endif  // HWY_ONCE
