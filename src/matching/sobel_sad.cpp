#include "matching/sobel_sad.h"

#include <tbb/parallel_for.h>

#include "matching/padded_image.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "matching/sobel_sad.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

#include "base/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace cbmv {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Words = hn::CappedTag<std::uint16_t, 32>;

/// Sums of absolute differences in the windows of the columns `span`. `columns` is scratch memory:
/// the sums down the columns, from two columns before `span` to two columns after it.
HWY_INLINE void sumDifferencesOfRun(const SobelSadMatcher::Rows& left,
                                    const SobelSadMatcher::Rows& right, int d,
                                    const ColumnSpan& span, std::uint16_t* columns,
                                    std::uint16_t* line) {
  constexpr int kRadius = SobelSadMatcher::kWindowPx / 2;
  const SobelSadMatcher::Rows l = left;
  const SobelSadMatcher::Rows r = right;
  forLanes(Words(), span.begin - kRadius, span.end + kRadius, [=](auto tag, int x, int) HWY_ATTR {
    const hn::RebindToSigned<decltype(tag)> signed_tag;
    auto sum = hn::Zero(tag);
    for (int row = 0; row < SobelSadMatcher::kWindowPx; ++row) {
      const auto difference =
          hn::Sub(hn::LoadU(signed_tag, l[row] + x), hn::LoadU(signed_tag, r[row] + x - d));
      sum = hn::Add(sum, hn::BitCast(tag, hn::Abs(difference)));
    }
    hn::StoreU(sum, tag, columns + x);
  });
  forLanes(Words(), span.begin, span.end, [=](auto tag, int x, int) HWY_ATTR {
    auto sum = hn::Zero(tag);
    for (int k = -kRadius; k <= kRadius; ++k) {
      sum = hn::Add(sum, hn::LoadU(tag, columns + x + k));
    }
    hn::StoreU(sum, tag, line + x);
  });
}

void sumDifferences(const SobelSadMatcher::Rows& left, const SobelSadMatcher::Rows& right,
                    const RowEntries& entries, std::uint16_t* columns, std::uint16_t* costs) {
  for (const RowEntries::Run& run : entries.runs()) {
    sumDifferencesOfRun(left, right, run.d, run.span, columns, costs + run.offset);
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace cbmv
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cbmv {
namespace {

HWY_EXPORT(sumDifferences);

SobelSadMatcher::Rows windowRows(const cv::Mat& padded, int y) {
  SobelSadMatcher::Rows rows{};
  for (int r = 0; r < SobelSadMatcher::kWindowPx; ++r) {
    rows[r] = paddedRow<std::int16_t>(padded, y + r - SobelSadMatcher::kWindowPx / 2);
  }
  return rows;
}

/// Computes the responses of the padded image without a margin of one pixel.
void computeResponses(const cv::Mat& padded, cv::Mat& responses) {
  responses.create(padded.size(), CV_16SC1);
  tbb::parallel_for(1, padded.rows - 1, [&](int y) {
    const auto* above = padded.ptr<std::uint8_t>(y - 1);
    const auto* here = padded.ptr<std::uint8_t>(y);
    const auto* below = padded.ptr<std::uint8_t>(y + 1);
    auto* out = responses.ptr<std::int16_t>(y);
    for (int x = 1; x < padded.cols - 1; ++x) {
      out[x] =
          static_cast<std::int16_t>(above[x + 1] - above[x - 1] + 2 * (here[x + 1] - here[x - 1]) +
                                    below[x + 1] - below[x - 1]);
    }
  });
}

}  // namespace

void SobelSadMatcher::prepare(const cv::Mat& padded_left, const cv::Mat& padded_right) {
  computeResponses(padded_left, left_responses_);
  computeResponses(padded_right, right_responses_);
}

void SobelSadMatcher::computeRow(int y, const RowEntries& entries, Scratch& scratch,
                                 CostRow<std::uint16_t>& costs) const {
  costs.resize(entries.count());
  scratch.resize(left_responses_.cols - 2 * kMatchingBorderPx);
  HWY_DYNAMIC_DISPATCH(sumDifferences)
  (windowRows(left_responses_, y), windowRows(right_responses_, y), entries,
   scratch.column_sums.data() + kWindowPx / 2, costs.entry(0));
}

}  // namespace cbmv
#endif  // HWY_ONCE
