#include "refinement/interpolation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>

#include <tbb/parallel_for.h>

#include "refinement/border_rows.h"
#include "refinement/left_right_check.h"

#ifndef CBMV_INTERPOLATION_ONCE
#define CBMV_INTERPOLATION_ONCE
namespace cbmv {
namespace {

constexpr int kDirections = 16;
constexpr int kQuarter = kDirections / 4;
/// Fractional bits of the distance along the minor axis. With this many bits, rounding the slopes
/// does not change any pixel of a ray within 2^15 steps.
constexpr int kFractionBits = 32;

/// A ray from a pixel. It moves in steps of one pixel along the image axis that is closer to its
/// direction.
struct Ray {
  cv::Point along;         ///< step along that axis
  cv::Point aside;         ///< step along the other axis
  std::int64_t slope = 0;  ///< aside per step along, in units of 2^-kFractionBits

  /// Distance aside after `steps` steps, in the same units. Rounding it down gives the nearest
  /// pixel.
  std::int64_t exactAside(int steps) const {
    return (std::int64_t{1} << (kFractionBits - 1)) + steps * slope;
  }
  /// The pixel after `steps` steps, relative to the first one.
  cv::Point pixel(int steps) const {
    return steps * along + static_cast<int>(exactAside(steps) >> kFractionBits) * aside;
  }
};
using Rays = std::array<Ray, kDirections>;

/// The maps from which mismatches are filled, and the filled map, row by row.
struct Maps {
  cv::Size size;
  const std::uint8_t* labels;
  const float* disparity;
  float* filled;
  float without_match;
};

constexpr float kUnknown = std::numeric_limits<float>::infinity();

/// The disparity of the nearest match on the ray from `start` after more than `steps` steps.
/// kUnknown if the ray leaves the image without a match.
inline float nearestMatch(const Maps& maps, const cv::Point& start, const Ray& ray, int steps) {
  for (;;) {
    const cv::Point at = start + ray.pixel(++steps);
    if (!at.inside(cv::Rect({0, 0}, maps.size))) {
      return kUnknown;
    }
    const std::ptrdiff_t pixel = static_cast<std::ptrdiff_t>(at.y) * maps.size.width + at.x;
    if (maps.labels[pixel] == kMatch) {
      return maps.disparity[pixel];
    }
  }
}

}  // namespace
}  // namespace cbmv
#endif

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "refinement/interpolation.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

#include "refinement/sorting-inl.h"

HWY_BEFORE_NAMESPACE();
namespace cbmv {
namespace HWY_NAMESPACE {
namespace {

/// Number of steps between tests for a match. Most rays are short, and a mispredicted branch costs
/// more than all of these steps.
constexpr int kStride = 8;

/// Lanes of the neighboring pixels that have the label.
template <class D>
HWY_INLINE hn::Mask<D> haveLabel(D tag, const std::uint8_t* labels, Label label) {
  const hn::RebindToSigned<D> wide_tag;
  const auto wide = hn::PromoteTo(wide_tag, hn::LoadU(hn::Rebind<std::uint8_t, D>(), labels));
  return hn::RebindMask(tag, hn::Eq(wide, hn::Set(wide_tag, label)));
}

/// Calls f(lane) for the lanes of a mask.
template <class D, class F>
HWY_INLINE void forEachOf(D tag, hn::Mask<D> lanes, const F& f) {
  std::uint8_t bytes[8] = {};
  hn::StoreMaskBits(tag, lanes, bytes);
  for (unsigned rest = bytes[0] | static_cast<unsigned>(bytes[1]) << 8; rest != 0;
       rest &= rest - 1) {
    f(static_cast<int>(hwy::Num0BitsBelowLS1Bit_Nonzero32(rest)));
  }
}

/// Follows the rays of one direction from the `open` ones of the neighboring pixels from `start`
/// on. Sets their lanes of `nearest` to the disparities of the nearest matches, or to kUnknown
/// where the ray leaves the image without a match.
template <class D>
HWY_INLINE void walk(D tag, const Maps& maps, const cv::Point& start, const Ray& ray,
                     hn::Mask<D> open, float* nearest) {
  const std::ptrdiff_t width = maps.size.width;
  const std::ptrdiff_t along = ray.along.y * width + ray.along.x;
  const std::ptrdiff_t aside = ray.aside.y * width + ray.aside.x;
  const cv::Rect whole_vectors(0, 0, maps.size.width - static_cast<int>(hn::Lanes(tag)) + 1,
                               maps.size.height);
  auto found = hn::Set(tag, kUnknown);
  int steps = 0;
  while (!hn::AllFalse(tag, open) && (start + ray.pixel(steps + kStride)).inside(whole_vectors)) {
    steps += kStride;
    std::ptrdiff_t on_axis = start.y * width + start.x + steps * along;
    std::int64_t exact_aside = ray.exactAside(steps);
    auto met = hn::FirstN(tag, 0);
    auto values = found;
    for (int i = 0; i < kStride; ++i) {  // backwards: the nearest match overwrites the others
      const std::ptrdiff_t pixel = on_axis + (exact_aside >> kFractionBits) * aside;
      const auto is_match = haveLabel(tag, maps.labels + pixel, kMatch);
      values = hn::IfThenElse(is_match, hn::LoadU(tag, maps.disparity + pixel), values);
      met = hn::Or(met, is_match);
      on_axis -= along;
      exact_aside -= ray.slope;
    }
    found = hn::IfThenElse(open, values, found);
    open = hn::AndNot(met, open);
  }
  hn::StoreU(found, tag, nearest);
  forEachOf(tag, open, [&](int lane) {
    nearest[lane] = nearestMatch(maps, start + cv::Point(lane, 0), ray, steps);
  });
}

/// Replaces the unknown values by ∞ and −∞ in turn. Then the eighth of all values is the median of
/// the known ones (the lower of two middle values), and −∞ if none is known.
template <class D>
HWY_INLINE void balanceUnknown(D tag, float* values) {
  const auto unknown = hn::Set(tag, kUnknown);
  auto filler = unknown;
  for (int k = 0; k < kDirections; ++k, values += hn::Lanes(tag)) {
    const auto value = hn::Load(tag, values);
    const auto is_unknown = hn::Eq(value, unknown);
    hn::Store(hn::IfThenElse(is_unknown, filler, value), tag, values);
    filler = hn::IfThenElse(is_unknown, hn::Neg(filler), filler);
  }
}

/// The eighth of the kDirections values of each lane. It is the largest of the lower eight, which
/// are known when both halves are sorted. Reorders the values.
template <class D>
HWY_INLINE hn::Vec<D> eighthOf(D tag, float* values) {
  const auto lanes = static_cast<std::ptrdiff_t>(hn::Lanes(tag));
  float* half = values + kDirections / 2 * lanes;
  sortEight(tag, values);
  sortEight(tag, half);
  auto largest = hn::Neg(hn::Inf(tag));
  for (int k = 0; k < kDirections / 2; ++k) {
    const auto other = hn::Load(tag, half + (kDirections / 2 - 1 - k) * lanes);
    largest = hn::Max(largest, hn::Min(hn::Load(tag, values + k * lanes), other));
  }
  return largest;
}

/// Fills the mismatched ones of the neighboring pixels from `start` on.
template <class D>
HWY_INLINE void fillVector(D tag, const Maps& maps, const cv::Point& start, const Rays& rays) {
  const std::ptrdiff_t first = static_cast<std::ptrdiff_t>(start.y) * maps.size.width + start.x;
  const auto mismatches = haveLabel(tag, maps.labels + first, kMismatch);
  if (hn::AllFalse(tag, mismatches)) {
    return;
  }
  HWY_ALIGN float nearest[kDirections * kLongestVector];
  for (int k = 0; k < kDirections; ++k) {
    walk(tag, maps, start, rays[k], mismatches, nearest + k * hn::Lanes(tag));
  }
  balanceUnknown(tag, nearest);
  const auto median = eighthOf(tag, nearest);
  hn::Store(hn::IfThenElse(hn::IsInf(median), hn::Set(tag, maps.without_match), median), tag,
            nearest);
  forEachOf(tag, mismatches, [&](int lane) { maps.filled[first + lane] = nearest[lane]; });
}

void fillMismatchesOfRow(const Maps& maps, int y, const Rays& rays) {
  forLanes(Floats(), 0, maps.size.width, [&](auto tag, int x, int) HWY_ATTR {
    fillVector(tag, maps, {x, y}, rays);
  });
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace cbmv
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cbmv {
namespace {

HWY_EXPORT(fillMismatchesOfRow);

/// Rays at k · 22.5°, from the x axis to the y axis.
Rays makeRays() {
  const cv::Point axes[] = {{1, 0}, {0, 1}, {-1, 0}, {0, -1}, {1, 0}};
  Rays rays;
  for (int k = 0; k < kDirections; ++k) {
    const cv::Point& before = axes[k / kQuarter];
    const cv::Point& after = axes[k / kQuarter + 1];
    const int turn = k % kQuarter;
    const int from_nearer = std::min(turn, kQuarter - turn);
    const double slope = std::tan(2 * CV_PI * from_nearer / kDirections);
    rays[k] = {2 * turn <= kQuarter ? before : after, 2 * turn <= kQuarter ? after : before,
               std::llround(std::ldexp(slope, kFractionBits))};
  }
  return rays;
}

void checkMaps(const cv::Mat& labels, const cv::Mat& disparity) {
  CV_Assert(labels.type() == CV_8UC1 && disparity.type() == CV_32FC1);
  CV_Assert(labels.size() == disparity.size());
}

/// The disparity of the first match of a row. Empty if there is none.
std::optional<float> firstMatch(const cv::Mat& labels, const cv::Mat& disparity, int y) {
  const auto* row = labels.ptr<std::uint8_t>(y);
  const auto* match = std::find(row, row + labels.cols, kMatch);
  return match != row + labels.cols ? std::optional(disparity.at<float>(y, match - row))
                                    : std::nullopt;
}

/// The value for the strip at the left border, which has no match to its left.
float disparityOfLeftBorder(const cv::Mat& labels, const cv::Mat& disparity, int y, float invalid) {
  const bool any_match = firstMatch(labels, disparity, y).has_value();
  const auto first_match = [&](int row) { return firstMatch(labels, disparity, row); };
  return any_match ? *medianOfRows(y, labels.rows, first_match) : invalid;
}

void fillOcclusionsOfRow(const cv::Mat& labels, int y, float invalid, cv::Mat& disparity) {
  const auto* label = labels.ptr<std::uint8_t>(y);
  auto* filled = disparity.ptr<float>(y);
  const int width = labels.cols;
  float background =
      label[0] == kMatch ? filled[0] : disparityOfLeftBorder(labels, disparity, y, invalid);
  for (int x = firstUnmatched(label, 0, width); x < width;
       x = firstUnmatched(label, x + 1, width)) {
    if (x > 0 && label[x - 1] == kMatch) {
      background = filled[x - 1];
    }
    if (label[x] == kOcclusion) {
      filled[x] = background;
    }
  }
}

}  // namespace

void fillOcclusions(const cv::Mat& labels, const DisparityRange& range, cv::Mat& disparity) {
  checkMaps(labels, disparity);
  // Rows can be filled in parallel: only matches are read from other rows, and matches are never
  // written.
  tbb::parallel_for(0, labels.rows,
                    [&](int y) { fillOcclusionsOfRow(labels, y, range.invalid(), disparity); });
}

void fillMismatches(const cv::Mat& labels, const DisparityRange& range, const cv::Mat& disparity,
                    cv::Mat& filled) {
  checkMaps(labels, disparity);
  checkMaps(labels, filled);
  CV_Assert(labels.isContinuous() && disparity.isContinuous() && filled.isContinuous());
  CV_Assert(disparity.data != filled.data);
  const Rays rays = makeRays();
  const Maps maps{labels.size(), labels.ptr<std::uint8_t>(), disparity.ptr<float>(),
                  filled.ptr<float>(), range.invalid()};
  tbb::parallel_for(0, labels.rows, [&](int y) {
    HWY_DYNAMIC_DISPATCH(fillMismatchesOfRow)(maps, y, rays);
  });
}

}  // namespace cbmv
#endif  // HWY_ONCE
