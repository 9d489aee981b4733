#include "optimization/support_arms.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>

#include <tbb/parallel_for.h>

#include "cbmv_stereo/error.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "optimization/support_arms.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

#include "base/lanes-inl.h"

#ifndef CBMV_OPTIMIZATION_SUPPORT_ARMS_ONCE
#define CBMV_OPTIMIZATION_SUPPORT_ARMS_ONCE
namespace cbmv {
namespace {

constexpr int kMostReach = 254;

/// Pixels of a row that are copied together with their neighbors on the row.
constexpr int kBlock = 512;

/// An arm has at most `reach` pixels, which differ from the center by at most `largest_step` gray
/// levels.
struct ArmLimits {
  int reach;
  std::uint8_t largest_step;
};

}  // namespace
}  // namespace cbmv
#endif

HWY_BEFORE_NAMESPACE();
namespace cbmv {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

/// Lengths of the arms of neighboring pixels in one direction. The k-th neighbors are at k * stride
/// from `centers`. At most `reach` of them are tested.
template <class D>
HWY_INLINE hn::Vec<D> growArms(D tag, const std::uint8_t* centers, std::ptrdiff_t stride, int reach,
                               hn::Vec<D> largest_step) {
  const auto center = hn::LoadU(tag, centers);
  auto lengths = hn::Zero(tag);
  auto growing = hn::Eq(lengths, lengths);
  for (int k = 1; k <= reach && !hn::AllFalse(tag, growing); ++k) {
    const auto neighbor = hn::LoadU(tag, centers + k * stride);
    const auto step =
        hn::Or(hn::SaturatedSub(center, neighbor), hn::SaturatedSub(neighbor, center));
    growing = hn::And(growing, hn::Eq(hn::Min(step, largest_step), step));
    lengths = hn::Sub(lengths, hn::VecFromMask(tag, growing));
  }
  return lengths;
}

/// The arms of a row. Left and right arms ignore the image borders.
void growArmsOfRow(const cv::Mat& image, int y, const ArmLimits& limits, std::uint8_t* arms) {
  const auto stride = static_cast<std::ptrdiff_t>(image.step1());
  const int up = std::min(limits.reach, y);
  const int down = std::min(limits.reach, image.rows - 1 - y);
  const auto* row = image.ptr<std::uint8_t>(y);
  std::array<std::uint8_t, kMostReach + kBlock + kMostReach> around{};
  for (int first = 0; first < image.cols; first += kBlock) {
    const int end = std::min(first + kBlock, image.cols);
    const int copied = std::max(first - limits.reach, 0);
    std::copy(row + copied, row + std::min(end + limits.reach, image.cols),
              around.begin() + kMostReach + copied - first);
    forLanes(hn::ScalableTag<std::uint8_t>(), first, end, [&](auto tag, int x, int) HWY_ATTR {
      const auto step = hn::Set(tag, limits.largest_step);
      const std::uint8_t* centers = around.data() + kMostReach + x - first;
      hn::StoreInterleaved4(growArms(tag, centers, -1, limits.reach, step),
                            growArms(tag, centers, 1, limits.reach, step),
                            growArms(tag, row + x, -stride, up, step),
                            growArms(tag, row + x, stride, down, step), tag, arms + 4 * x);
    });
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace cbmv
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cbmv {
namespace {

HWY_EXPORT(growArmsOfRow);

void endArmsInsideOfRow(int width, int reach, cv::Vec4b* arms) {
  for (int x = 0; x < std::min(reach, width); ++x) {
    arms[x][0] = std::min(arms[x][0], static_cast<std::uint8_t>(x));
    std::uint8_t& mirrored = arms[width - 1 - x][1];
    mirrored = std::min(mirrored, static_cast<std::uint8_t>(x));
  }
}

}  // namespace

void computeSupportArms(const cv::Mat& gray, int max_length, float threshold_gray, cv::Mat& arms) {
  CV_Assert(gray.type() == CV_8UC1);
  if (max_length < 1 || max_length > kMostReach + 1) {
    throw Error("The arm length of cost aggregation is " + std::to_string(max_length) +
                " px; it must be between 1 and 255.");
  }
  const cv::Mat image = gray;  // keeps the image valid if `arms` is the same object
  arms.create(image.size(), CV_8UC4);
  // An integer is below the threshold exactly if it is below the threshold rounded up.
  const int threshold = static_cast<int>(std::ceil(std::min(threshold_gray, 256.0F)));
  const ArmLimits limits{threshold > 0 ? max_length - 1 : 0,
                         static_cast<std::uint8_t>(std::max(threshold - 1, 0))};
  tbb::parallel_for(0, image.rows, [&](int y) {
    HWY_DYNAMIC_DISPATCH(growArmsOfRow)(image, y, limits, arms.ptr<std::uint8_t>(y));
    endArmsInsideOfRow(image.cols, limits.reach, arms.ptr<cv::Vec4b>(y));
  });
}

}  // namespace cbmv
#endif  // HWY_ONCE
