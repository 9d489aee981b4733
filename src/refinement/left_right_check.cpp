#include "refinement/left_right_check.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#ifndef CBMV_REFINEMENT_LEFT_RIGHT_CHECK_ONCE
#define CBMV_REFINEMENT_LEFT_RIGHT_CHECK_ONCE
namespace cbmv {
namespace {

/// Bits of a left column, set from right pixels.
constexpr std::uint8_t kAgrees = 1;   ///< a right pixel agrees at a disparity of the range
constexpr std::uint8_t kMatchOf = 2;  ///< matched by a right pixel with a disparity in the range

/// One row of disparities of the right view.
struct RightRow {
  const float* disparity;
  int width;
  DisparityRange range;
  float max_difference_px;

  /// For a right column with a whole-pixel disparity in the range, only the matching left column is
  /// marked. Columns up to this distance from it agree as well. −1: matching columns are not
  /// marked.
  int matchReach() const {
    return max_difference_px >= 0 && max_difference_px < 2 ? static_cast<int>(max_difference_px)
                                                           : -1;
  }

  /// Sets kAgrees for left columns that agree with the right `column` at a whole-pixel disparity of
  /// the range.
  void markAgreeing(int column, std::uint8_t* marks) const {
    const float d = disparity[column];
    const float lowest = d - max_difference_px;
    const float highest = d + max_difference_px;
    const auto min = static_cast<float>(range.min);
    const auto max = static_cast<float>(range.max());
    if (d == range.invalid() || !(lowest <= max + 1 && highest >= min - 1)) {
      return;
    }
    // Except for rounding, d' agrees if lowest ≤ d' ≤ highest. The next values on both sides are
    // tested too.
    const int first =
        std::max({column + static_cast<int>(std::max(lowest, min)) - 1, column + range.min, 0});
    const int last = std::min(
        {column + static_cast<int>(std::min(highest, max)) + 1, column + range.max(), width - 1});
    const float limit = max_difference_px;  // local copy: storing a byte may alias any member
    for (int x = first; x <= last; ++x) {
      const float difference = std::abs(static_cast<float>(x - column) - d);
      marks[x] |= difference <= limit ? kAgrees : 0;
    }
  }
};

}  // namespace
}  // namespace cbmv
#endif

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "refinement/left_right_check.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

#include "base/lanes-inl.h"
#include "refinement/padded_disparity.h"

HWY_BEFORE_NAMESPACE();
namespace cbmv {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Floats = hn::CappedTag<float, kLongestVector>;

/// Left columns that the right columns from `column` on match. −1 if the disparity is not a whole
/// number in the range, or if the match is outside of the image.
template <class D>
HWY_INLINE hn::Vec<hn::RebindToSigned<D>> matchesOf(D tag, const RightRow& row, int column) {
  const hn::RebindToSigned<D> integers;
  const auto d = hn::LoadU(tag, row.disparity + column);
  const auto lowest = hn::Set(tag, static_cast<float>(row.range.min));
  const auto highest = hn::Set(tag, static_cast<float>(row.range.max()));
  const auto whole = hn::ConvertTo(integers, hn::Min(hn::Max(d, lowest), highest));
  const auto x = hn::Add(countFrom(integers, column), whole);
  const auto is_whole = hn::Eq(hn::ConvertTo(tag, whole), d);
  const auto is_within = hn::And(hn::Gt(d, lowest), hn::Lt(d, highest));
  const auto matches = hn::RebindMask(integers, hn::And(is_whole, is_within));
  const auto none = hn::Set(integers, -1);
  const auto is_column = hn::Lt(x, hn::Set(integers, row.width));
  return hn::IfThenElse(hn::And(matches, is_column), hn::Max(x, none), none);
}

/// Marks the left columns of a row. All marks must be 0 before.
void markRow(const RightRow& row, std::uint8_t* marks) {
  if (row.matchReach() < 0) {
    for (int column = 0; column < row.width; ++column) {
      row.markAgreeing(column, marks);
    }
    return;
  }
  forLanes(Floats(), 0, row.width, [&](auto tag, int column, int) HWY_ATTR {
    const hn::RebindToSigned<decltype(tag)> integers;
    const auto matches = matchesOf(tag, row, column);
    HWY_ALIGN std::int32_t columns[kLongestVector];
    hn::Store(matches, integers, columns);
    const bool all_match = hn::AllFalse(integers, hn::Lt(matches, hn::Zero(integers)));
    for (int i = 0; i < static_cast<int>(hn::Lanes(tag)); ++i) {
      if (all_match || columns[i] >= 0) {
        marks[columns[i]] = kMatchOf;  // includes kAgrees
      } else {
        row.markAgreeing(column + i, marks);
      }
    }
  });
}

/// Lanes of the left pixels from column x on, with disparities `d`, that agree with the right
/// pixels.
template <class D>
HWY_INLINE hn::Mask<D> agree(D tag, const RightRow& right, int x, hn::Vec<D> d) {
  const hn::RebindToSigned<D> integers;
  const auto width = hn::Set(integers, right.width);
  const auto invalid = hn::Set(tag, right.range.invalid());
  const auto exact = hn::Sub(hn::ConvertTo(tag, countFrom(integers, x)), d);
  const auto near = hn::And(hn::Gt(exact, hn::Set(tag, -0.5F)),
                            hn::Lt(exact, hn::Set(tag, static_cast<float>(right.width))));
  const auto inside = hn::IfThenElseZero(near, exact);
  const auto below = hn::ConvertTo(integers, inside);
  const auto rounds_up = hn::Ge(hn::Sub(inside, hn::ConvertTo(tag, below)), hn::Set(tag, 0.5F));
  const auto column =
      hn::Sub(below, hn::VecFromMask(integers, hn::RebindMask(integers, rounds_up)));
  const auto is_column = hn::Lt(column, width);
  const auto other = hn::GatherIndex(tag, right.disparity, hn::IfThenElseZero(is_column, column));
  const auto difference = hn::Abs(hn::Sub(d, other));
  const auto close = hn::Le(difference, hn::Set(tag, right.max_difference_px));
  const auto valid = hn::And(hn::Ne(other, invalid), hn::Ne(d, invalid));
  return hn::And(hn::And(near, hn::RebindMask(tag, is_column)), hn::And(valid, close));
}

/// Labels of neighboring pixels from column x on. `marks` are the marks of these pixels and of one
/// more on either side.
template <class D>
HWY_INLINE void labelVector(D tag, const float* left, const RightRow& right, int x,
                            const std::uint8_t* marks, std::uint8_t* labels) {
  const hn::Rebind<std::uint8_t, D> bytes;
  const hn::RebindToSigned<D> words;
  const auto beside = hn::Or(hn::LoadU(bytes, marks - 1), hn::LoadU(bytes, marks + 1));
  const auto mark_beside = hn::Set(bytes, right.matchReach() == 1 ? kMatchOf : std::uint8_t{0});
  const auto here = hn::Or(hn::LoadU(bytes, marks), hn::And(beside, mark_beside));
  const auto is_occlusion = hn::Eq(hn::PromoteTo(words, here), hn::Zero(words));
  const auto other =
      hn::IfThenElse(is_occlusion, hn::Set(words, kOcclusion), hn::Set(words, kMismatch));
  const auto matches = hn::RebindMask(words, agree(tag, right, x, hn::LoadU(tag, left + x)));
  const auto label = hn::IfThenElse(matches, hn::Set(words, kMatch), other);
  hn::StoreU(hn::DemoteTo(bytes, label), bytes, labels + x);
}

/// Replaces the marks of the row in `labels` by its labels. Marks are copied, because marks of
/// neighbors are read after labels have overwritten them.
void labelRow(const float* left, const RightRow& right, std::uint8_t* labels) {
  constexpr int kBlock = 512;
  std::array<std::uint8_t, kBlock + 2> marks;
  marks[0] = 0;
  for (int first = 0; first < right.width; first += kBlock) {
    const int end = std::min(first + kBlock, right.width);
    const int copied = std::min(end + 1, right.width);
    std::copy(labels + first, labels + copied, marks.begin() + 1);
    marks[end - first + 1] = copied > end ? marks[end - first + 1] : std::uint8_t{0};
    forLanes(Floats(), first, end, [&](auto tag, int x, int) HWY_ATTR {
      labelVector(tag, left, right, x, marks.data() + 1 + x - first, labels);
    });
    marks[0] = marks[end - first];
  }
}

/// `labels` must be 0 before.
void checkRow(const float* left, const RightRow& right, std::uint8_t* labels) {
  markRow(right, labels);
  labelRow(left, right, labels);
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace cbmv
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cbmv {
namespace {

HWY_EXPORT(checkRow);

}  // namespace

void leftRightCheck(const cv::Mat& left_disparity, const cv::Mat& right_disparity,
                    const DisparityRange& range, float max_difference_px, cv::Mat& labels) {
  CV_Assert(left_disparity.type() == CV_32FC1 && right_disparity.type() == CV_32FC1);
  CV_Assert(left_disparity.size() == right_disparity.size());
  labels.create(left_disparity.size(), CV_8UC1);
  tbb::parallel_for(tbb::blocked_range<int>(0, labels.rows), [&](const auto& rows) {
    for (int y = rows.begin(); y != rows.end(); ++y) {
      auto* out = labels.ptr<std::uint8_t>(y);
      std::fill_n(out, labels.cols, std::uint8_t{0});
      HWY_DYNAMIC_DISPATCH(checkRow)
      (left_disparity.ptr<float>(y),
       RightRow{right_disparity.ptr<float>(y), labels.cols, range, max_difference_px}, out);
    }
  });
}

}  // namespace cbmv
#endif  // HWY_ONCE
