#include "refinement/median_filter.h"

#include <algorithm>
#include <cstddef>
#include <string>

#include <tbb/parallel_for.h>

#include "refinement/padded_disparity.h"

#include "cbmv_stereo/error.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "refinement/median_filter.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

#include "refinement/sorting-inl.h"

HWY_BEFORE_NAMESPACE();
namespace cbmv {
namespace HWY_NAMESPACE {
namespace {

using Vector = hn::Vec<Floats>;

/// Sorts two vectors in memory, lane by lane.
HWY_INLINE void sortStored(float* low, float* high) {
  const auto a = hn::Load(Floats(), low);
  const auto b = hn::Load(Floats(), high);
  hn::Store(hn::Min(a, b), Floats(), low);
  hn::Store(hn::Max(a, b), Floats(), high);
}

/// Loads all pixels of neighboring windows, one window per lane, as vectors into `values`. The
/// first window starts at `window`; `stride` is the distance to its next row.
///
/// Invalid pixels become −∞ and ∞ in turn. So the median of the valid ones (the lower of two middle
/// values) stays in the middle.
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

/// Moves the smallest of `count` vectors, lane by lane, to the first and the largest to the last.
HWY_INLINE void sortEnds(float* first, float* last, int count) {
  const auto lanes = static_cast<std::ptrdiff_t>(hn::Lanes(Floats()));
  for (int i = 0; i < count / 2; ++i) {
    sortStored(first + i * lanes, last - i * lanes);
  }
  for (int i = 1; i < (count + 1) / 2; ++i) {
    sortStored(first, first + i * lanes);
    sortStored(last - i * lanes, last);
  }
}

/// Median of `count` (odd) vectors, which are reordered. In any set of more than half of them,
/// neither the smallest nor the largest is the median. So both can be removed and another one
/// added.
HWY_INLINE Vector median(float* values, int count) {
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

/// Medians of the valid pixels of windows. Invalid centers stay invalid. `values` is scratch memory
/// for the vectors of all pixels of a window.
HWY_INLINE Vector medianOfValid(const float* window, std::ptrdiff_t stride, int size, float invalid,
                                float* values) {
  loadWindows(window, stride, size, invalid, values);
  const auto center = hn::LoadU(Floats(), window + size / 2 * stride + size / 2);
  const auto is_invalid = hn::Eq(center, hn::Set(Floats(), invalid));
  return hn::IfThenElse(is_invalid, center, median(values, size * size));
}

/// Medians around the pixels of a row. `padded` points to the upper left corner of the first
/// window. Reads whole vectors.
void filterRow(const float* padded, std::ptrdiff_t stride, int width, int size, float invalid,
               float* medians) {
  const Floats tag;
  HWY_ALIGN float values[kMaxMedianSizePx * kMaxMedianSizePx * kLongestVector];
  for (int x = 0; x < width; x += static_cast<int>(hn::Lanes(tag))) {
    storeFirst(tag, medianOfValid(padded + x, stride, size, invalid, values), width - x,
               medians + x);
  }
}

/// Sorts the values of each lane.
HWY_INLINE void sortThree(Vector& a, Vector& b, Vector& c) {
  sortPair(a, b);
  sortPair(b, c);
  sortPair(a, b);
}

/// Medians of 3 × 3 windows. After sorting the columns, the result is the median of three values:
/// the largest of the lows, the median of the middles and the smallest of the highs.
HWY_INLINE Vector medianOfNine(const float* window, std::ptrdiff_t stride, float invalid) {
  const Floats tag;
  const auto load = [=](int y, int x) HWY_ATTR { return hn::LoadU(tag, window + y * stride + x); };
  auto low0 = load(0, 0), middle0 = load(1, 0), high0 = load(2, 0);
  auto low1 = load(0, 1), middle1 = load(1, 1), high1 = load(2, 1);
  auto low2 = load(0, 2), middle2 = load(1, 2), high2 = load(2, 2);
  sortThree(low0, middle0, high0);
  sortThree(low1, middle1, high1);
  sortThree(low2, middle2, high2);
  const auto lowest = hn::Min(hn::Min(low0, low1), low2);
  if (!hn::AllTrue(tag, hn::Gt(lowest, hn::Set(tag, invalid)))) {
    HWY_ALIGN float values[3 * 3 * kLongestVector];
    return medianOfValid(window, stride, 3, invalid, values);
  }
  auto low = hn::Max(hn::Max(low0, low1), low2);
  auto high = hn::Min(hn::Min(high0, high1), high2);
  sortThree(middle0, middle1, middle2);
  sortThree(low, middle1, high);
  return middle1;
}

/// Copies the pixels of the 3 × 3 windows around one vector of pixels of row y from column x on.
/// Pixels outside of the image are invalid.
HWY_INLINE void padWindows(const cv::Mat& disparity, int y, int x, float invalid, float* block) {
  const int width = static_cast<int>(hn::Lanes(Floats())) + 2;
  std::fill_n(block, 3 * width, invalid);
  const int begin = std::max(x - 1, 0);
  const int end = std::min(x - 1 + width, disparity.cols);
  for (int row = std::max(y - 1, 0); row <= std::min(y + 1, disparity.rows - 1); ++row) {
    const auto* in = disparity.ptr<float>(row);
    std::copy(in + begin, in + end, block + (row - (y - 1)) * width + begin - (x - 1));
  }
}

/// Medians of the 3 × 3 windows around the pixels of a row.
void filterRowByThree(const cv::Mat& disparity, int y, float invalid, float* medians) {
  const Floats tag;
  const int lanes = static_cast<int>(hn::Lanes(tag));
  float block[3 * (kLongestVector + 2)];
  const bool is_inner_row = y > 0 && y + 1 < disparity.rows;
  for (int x = 0; x < disparity.cols; x += lanes) {
    const bool is_inner = is_inner_row && x > 0 && x + lanes < disparity.cols;
    if (!is_inner) {
      padWindows(disparity, y, x, invalid, block);
    }
    const auto found = is_inner
                           ? medianOfNine(disparity.ptr<float>(y - 1) + x - 1,
                                          static_cast<std::ptrdiff_t>(disparity.step1()), invalid)
                           : medianOfNine(block, lanes + 2, invalid);
    storeFirst(tag, found, disparity.cols - x, medians + x);
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
HWY_EXPORT(filterRowByThree);

}  // namespace

void medianFilter(const cv::Mat& disparity, const DisparityRange& range, int size_px,
                  cv::Mat& padded, cv::Mat& filtered) {
  CV_Assert(disparity.type() == CV_32FC1 && disparity.data != filtered.data);
  if (size_px < 1 || size_px > kMaxMedianSizePx || size_px % 2 == 0) {
    throw Error("The size of the median filter is " + std::to_string(size_px) +
                " px; it must be odd and between 1 and " + std::to_string(kMaxMedianSizePx) + ".");
  }
  filtered.create(disparity.size(), CV_32FC1);
  if (size_px == 3) {
    tbb::parallel_for(0, disparity.rows, [&](int y) {
      HWY_DYNAMIC_DISPATCH(filterRowByThree)(disparity, y, range.invalid(), filtered.ptr<float>(y));
    });
    return;
  }
  padDisparity(disparity, range.invalid(), size_px / 2, range.invalid(), padded);
  tbb::parallel_for(0, disparity.rows, [&](int y) {
    HWY_DYNAMIC_DISPATCH(filterRow)
    (padded.ptr<float>(y), static_cast<std::ptrdiff_t>(padded.step1()), disparity.cols, size_px,
     range.invalid(), filtered.ptr<float>(y));
  });
}

}  // namespace cbmv
#endif  // HWY_ONCE
