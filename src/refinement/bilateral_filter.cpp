#include "cbmv_stereo/refinement/bilateral_filter.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <limits>
#include <string>
#include <vector>

#include <tbb/parallel_for.h>

#include "refinement/padded_disparity.h"

#include "cbmv_stereo/error.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "refinement/bilateral_filter.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

#include "simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace cbmv {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Floats = hn::CappedTag<float, kLongestVector>;

/// Means over the windows of a row of pixels; `centres` are whole vectors long. Sums up
/// differences to the centre, because they are small and float loses little of them. Invalid
/// centres are infinite, and thus far away even from themselves.
void filterRow(const float* centres, std::ptrdiff_t stride, int width, const float* weights,
               int radius, float threshold_px, float invalid, float* out) {
  const Floats tag;
  const auto threshold = hn::Set(tag, threshold_px);
  for (int x = 0; x < width; x += static_cast<int>(hn::Lanes(tag))) {
    const auto centre = hn::LoadU(tag, centres + x);
    auto differences = hn::Zero(tag);
    auto weight_sum = hn::Zero(tag);
    for (int dy = -radius; dy <= radius; ++dy) {
      const float* row = centres + x + dy * stride;
      for (int dx = -radius; dx <= radius; ++dx) {
        const auto weight = hn::Set(tag, weights[std::abs(dy)] * weights[std::abs(dx)]);
        const auto difference = hn::Sub(hn::LoadU(tag, row + dx), centre);
        const auto near = hn::Lt(hn::Abs(difference), threshold);
        differences = hn::Add(differences, hn::IfThenElseZero(near, hn::Mul(weight, difference)));
        weight_sum = hn::Add(weight_sum, hn::IfThenElseZero(near, weight));
      }
    }
    const auto mean = hn::Add(centre, hn::Div(differences, weight_sum));
    const auto is_valid = hn::Gt(weight_sum, hn::Zero(tag));
    storeFirst(tag, hn::IfThenElse(is_valid, mean, hn::Set(tag, invalid)), width - x, out + x);
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

/// Of either axis, by distance: a Gaussian is separable.
std::vector<float> gaussian(float sigma_px, int radius) {
  std::vector<float> weights;
  for (int offset = 0; offset <= radius; ++offset) {
    weights.push_back(std::exp(-static_cast<float>(offset * offset) / (2 * sigma_px * sigma_px)));
  }
  return weights;
}

void checkOptions(float sigma_px, float threshold_px) {
  if (!(sigma_px >= 0)) {
    throw Error("The sigma of the bilateral filter is " + std::to_string(sigma_px) +
                " px; it must be 0 (no filter) or positive.");
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
  const std::vector<float> weights = gaussian(sigma_px, radius);
  // Infinite disparities are far away from all others: no window needs a test for the border.
  padDisparity(disparity, range.invalid(), radius, std::numeric_limits<float>::infinity(), padded);
  tbb::parallel_for(0, disparity.rows, [&](int y) {
    HWY_DYNAMIC_DISPATCH(filterRow)
    (padded.ptr<float>(y + radius) + radius, static_cast<std::ptrdiff_t>(padded.step1()),
     disparity.cols, weights.data(), radius, threshold_px, range.invalid(), filtered.ptr<float>(y));
  });
}

}  // namespace cbmv
#endif  // HWY_ONCE
