#include "cbmv_stereo/refinement/median_filter.h"

#include <cstddef>
#include <string>

#include <tbb/parallel_for.h>

#include "refinement/padded_disparity.h"

#include "cbmv_stereo/error.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "refinement/median_filter.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

#include "simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace cbmv {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Floats = hn::CappedTag<float, kLongestVector>;

HWY_INLINE void sortPair(float* low, float* high) {
  const auto a = hn::Load(Floats(), low);
  const auto b = hn::Load(Floats(), high);
  hn::Store(hn::Min(a, b), Floats(), low);
  hn::Store(hn::Max(a, b), Floats(), high);
}

/// The medians of as many neighbouring windows as a vector has lanes, the first of which starts at
/// `window`; `stride` leads to its next row. `values` holds vectors of all its pixels.
///
/// Invalid pixels count alternately as −∞ and ∞, which leaves the median of the valid ones in the
/// middle, the lower one of two.
HWY_INLINE void loadWindows(const float* window, std::ptrdiff_t stride, int size, float invalid,
                            float* values) {
  const Floats tag;
  const auto none = hn::Set(tag, invalid);
  auto filler = hn::Neg(hn::Inf(tag));
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x, values += hn::Lanes(tag)) {
      const auto pixel = hn::LoadU(tag, window + y * stride + x);
      const auto is_invalid = hn::Eq(pixel, none);
      hn::Store(hn::IfThenElse(is_invalid, filler, pixel), tag, values);
      filler = hn::IfThenElse(is_invalid, hn::Neg(filler), filler);
    }
  }
}

/// Brings the smallest of `count` vectors, lane by lane, to the first one and the largest to the
/// last.
HWY_INLINE void sortEnds(float* first, float* last, int count) {
  const auto lanes = static_cast<std::ptrdiff_t>(hn::Lanes(Floats()));
  for (int i = 0; i < count / 2; ++i) {
    sortPair(first + i * lanes, last - i * lanes);
  }
  for (int i = 1; i < (count + 1) / 2; ++i) {
    sortPair(first, first + i * lanes);
    sortPair(last - i * lanes, last);
  }
}

/// Median of `count` (odd) vectors, which are reordered. Of any set of more than half of them,
/// neither the smallest nor the largest is the median: these two can go and another one come in.
HWY_INLINE hn::Vec<Floats> median(float* values, int count) {
  const auto lanes = static_cast<std::ptrdiff_t>(hn::Lanes(Floats()));
  const int middle = count / 2;
  float* last = values + (middle + 1) * lanes;
  for (int i = 0; i < middle; ++i) {
    sortEnds(values + i * lanes, last, middle + 2 - i);
    if (i < middle - 1) {
      hn::Store(hn::Load(Floats(), last + (i + 1) * lanes), Floats(), last);
    }
  }
  return hn::Load(Floats(), values + middle * lanes);
}

/// Medians around the pixels of a row: `padded` points to the upper left corner of the first
/// window. Reads whole vectors.
void filterRow(const float* padded, std::ptrdiff_t stride, int width, int size, float invalid,
               float* medians) {
  const Floats tag;
  HWY_ALIGN float values[kMaxMedianSizePx * kMaxMedianSizePx * kLongestVector];
  const float* centres = padded + size / 2 * stride + size / 2;
  for (int x = 0; x < width; x += static_cast<int>(hn::Lanes(tag))) {
    loadWindows(padded + x, stride, size, invalid, values);
    const auto centre = hn::LoadU(tag, centres + x);
    const auto is_invalid = hn::Eq(centre, hn::Set(tag, invalid));
    storeFirst(tag, hn::IfThenElse(is_invalid, centre, median(values, size * size)), width - x,
               medians + x);
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace cbmv
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cbmv {
namespace {

HWY_EXPORT(filterRow);

}  // namespace

void medianFilter(const cv::Mat& disparity, const DisparityRange& range, int size_px,
                  cv::Mat& padded, cv::Mat& filtered) {
  CV_Assert(disparity.type() == CV_32FC1 && disparity.data != filtered.data);
  if (size_px < 1 || size_px > kMaxMedianSizePx || size_px % 2 == 0) {
    throw Error("The size of the median filter is " + std::to_string(size_px) +
                " px; it must be odd and between 1 and " + std::to_string(kMaxMedianSizePx) + ".");
  }
  const int radius = size_px / 2;
  padDisparity(disparity, range.invalid(), radius, range.invalid(), padded);
  filtered.create(disparity.size(), CV_32FC1);
  tbb::parallel_for(0, disparity.rows, [&](int y) {
    HWY_DYNAMIC_DISPATCH(filterRow)
    (padded.ptr<float>(y), static_cast<std::ptrdiff_t>(padded.step1()), disparity.cols, size_px,
     range.invalid(), filtered.ptr<float>(y));
  });
}

}  // namespace cbmv
#endif  // HWY_ONCE
