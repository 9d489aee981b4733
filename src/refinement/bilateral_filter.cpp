#include "refinement/bilateral_filter.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <limits>
#include <string>

#include <tbb/parallel_for.h>

#include "refinement/padded_disparity.h"

#include "cbmv_stereo/error.h"

#ifndef CBMV_REFINEMENT_BILATERAL_FILTER_ONCE
#define CBMV_REFINEMENT_BILATERAL_FILTER_ONCE
namespace cbmv {
namespace {

/// A window of 2 radius + 1 pixels along a column or a row.
struct Window {
  const float* weights;  ///< by distance from the center
  int radius;
  float threshold_px;
};

}  // namespace
}  // namespace cbmv
#endif

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "refinement/bilateral_filter.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

#include "base/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace cbmv {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Floats = hn::CappedTag<float, kLongestVector>;

/// Means over windows of neighboring pixels. sample(offset) returns the disparities at `offset`
/// from the centers, −before ≤ offset ≤ after. Sums the differences from the center, because they
/// are small and lose little precision in float. Infinite disparities differ from all others,
/// including themselves. As centers, they do not change.
template <class D, class Sample>
HWY_INLINE hn::Vec<D> meanOfNear(D tag, const Window& window, int before, int after,
                                 const Sample& sample) {
  const auto threshold = hn::Set(tag, window.threshold_px);
  const auto center = sample(0);
  auto differences = hn::Zero(tag);
  auto weight_sum = hn::Zero(tag);
  for (int offset = -before; offset <= after; ++offset) {
    const auto weight = hn::Set(tag, window.weights[std::abs(offset)]);
    const auto difference = hn::Sub(sample(offset), center);
    const auto near = hn::Lt(hn::Abs(difference), threshold);
    differences = hn::Add(differences, hn::IfThenElseZero(near, hn::Mul(weight, difference)));
    weight_sum = hn::Add(weight_sum, hn::IfThenElseZero(near, weight));
  }
  const auto mean = hn::Add(center, hn::Div(differences, weight_sum));
  return hn::IfThenElse(hn::Gt(weight_sum, hn::Zero(tag)), mean, center);
}

/// Means along the columns at row y. Invalid disparities become infinite.
void filterColumns(const cv::Mat& disparity, int y, const Window& window, float invalid,
                   float* means) {
  const int before = std::min(window.radius, y);
  const int after = std::min(window.radius, disparity.rows - 1 - y);
  const auto* row = disparity.ptr<float>(y);
  const auto stride = static_cast<std::ptrdiff_t>(disparity.step1());
  forLanes(Floats(), 0, disparity.cols, [&](auto tag, int x, int) HWY_ATTR {
    const auto sample = [=](int offset) HWY_ATTR {
      const auto values = hn::LoadU(tag, row + offset * stride + x);
      return hn::IfThenElse(hn::Eq(values, hn::Set(tag, invalid)), hn::Inf(tag), values);
    };
    hn::StoreU(meanOfNear(tag, window, before, after, sample), tag, means + x);
  });
}

/// Means along a row. `radius` pixels plus a vector beyond both ends are infinite.
void filterRow(const float* centers, int width, const Window& window, float invalid, float* means) {
  const Floats tag;
  for (int x = 0; x < width; x += static_cast<int>(hn::Lanes(tag))) {
    const auto sample = [=](int offset) HWY_ATTR { return hn::LoadU(tag, centers + x + offset); };
    const auto mean = meanOfNear(tag, window, window.radius, window.radius, sample);
    storeFirst(tag, hn::IfThenElse(hn::IsInf(mean), hn::Set(tag, invalid), mean), width - x,
               means + x);
  }
}

/// `between` is the row between both steps. It begins `radius` pixels before the first column and
/// is infinite.
void filterBoth(const cv::Mat& disparity, int y, const Window& window, float invalid,
                float* between, float* means) {
  filterColumns(disparity, y, window, invalid, between + window.radius);
  filterRow(between + window.radius, disparity.cols, window, invalid, means);
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace cbmv
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cbmv {
namespace {

HWY_EXPORT(filterBoth);

constexpr int kMaxRadius = static_cast<int>(3 * kMaxBilateralSigmaPx);
using Weights = std::array<float, kMaxRadius + 1>;

/// Weights along either axis by distance up to the radius: a Gaussian is separable.
Weights gaussian(float sigma_px, int radius) {
  Weights weights{};
  for (int offset = 0; offset <= radius; ++offset) {
    weights[offset] = std::exp(-static_cast<float>(offset * offset) / (2 * sigma_px * sigma_px));
  }
  return weights;
}

void checkOptions(float sigma_px, float threshold_px) {
  if (!(sigma_px >= 0 && sigma_px <= kMaxBilateralSigmaPx)) {
    throw Error("The sigma of the bilateral filter is " + std::to_string(sigma_px) +
                " px, expected a number from 0 (no filter) to " +
                std::to_string(kMaxBilateralSigmaPx) + ".");
  }
  if (!(threshold_px > 0)) {
    throw Error("The threshold of the bilateral filter is " + std::to_string(threshold_px) +
                " px; it must be positive.");
  }
}

}  // namespace

void bilateralFilter(const cv::Mat& disparity, const DisparityRange& range, float sigma_px,
                     float threshold_px, cv::Mat& padded, cv::Mat& filtered) {
  CV_Assert(disparity.type() == CV_32FC1 && disparity.data != filtered.data);
  checkOptions(sigma_px, threshold_px);
  if (sigma_px == 0) {
    disparity.copyTo(filtered);
    return;
  }
  filtered.create(disparity.size(), CV_32FC1);
  const int radius = static_cast<int>(std::ceil(3 * sigma_px));
  const Weights weights = gaussian(sigma_px, radius);
  padded.create(disparity.rows, disparity.cols + 2 * radius + kLongestVector, CV_32FC1);
  tbb::parallel_for(0, disparity.rows, [&](int y) {
    auto* row = padded.ptr<float>(y);
    std::fill_n(row, padded.cols, std::numeric_limits<float>::infinity());
    HWY_DYNAMIC_DISPATCH(filterBoth)
    (disparity, y, {weights.data(), radius, threshold_px}, range.invalid(), row,
     filtered.ptr<float>(y));
  });
}

}  // namespace cbmv
#endif  // HWY_ONCE
