#include "cbmv_stereo/optimization/winner_takes_all.h"

#include <cstdint>
#include <vector>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "optimization/inside_disparities.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "optimization/winner_takes_all.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

#include "optimization/cost_vectors-inl.h"

HWY_BEFORE_NAMESPACE();
namespace cbmv {
namespace HWY_NAMESPACE {
namespace {

/// `count` costs, padded by the largest number.
HWY_INLINE hn::Vec<LineTag<std::uint16_t>> loadFirst(const std::uint16_t* costs, int count) {
  const LineTag<std::uint16_t> tag;
  const auto values = hn::LoadU(tag, costs);
  return count >= static_cast<int>(hn::Lanes(tag))
             ? values
             : hn::IfThenElse(hn::FirstN(tag, count), values, hn::Set(tag, 0xffff));
}

/// Index of the first smallest of `count` ≥ 1 costs.
int findCheapest(const std::uint16_t* costs, int count) {
  const LineTag<std::uint16_t> tag;
  const auto lanes = static_cast<int>(hn::Lanes(tag));
  auto lowest = loadFirst(costs, count);
  for (int i = lanes; i < count; i += lanes) {
    lowest = hn::Min(lowest, loadFirst(costs + i, count - i));
  }
  lowest = hn::MinOfLanes(tag, lowest);
  int first = 0;
  while (hn::AllFalse(tag, hn::Eq(hn::LoadU(tag, costs + first), lowest))) {
    first += lanes;
  }
  const auto found = hn::Eq(hn::LoadU(tag, costs + first), lowest);
  return first + static_cast<int>(hn::FindFirstTrue(tag, found));
}

/// The cheapest of the hypotheses inside[x] of each pixel, or `invalid` where there are none.
void findWinners(const std::uint16_t* costs, int disparities, const cv::Range* inside, int columns,
                 float lowest_disparity, float invalid, float* winners) {
  for (int x = 0; x < columns; ++x, costs += disparities) {
    const int start = inside[x].start;
    const int count = inside[x].end - start;
    winners[x] = count > 0 ? lowest_disparity +
                                 static_cast<float>(start + findCheapest(costs + start, count))
                           : invalid;
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace cbmv
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cbmv {
namespace {

HWY_EXPORT(findWinners);

}  // namespace

void winnerTakesAll(const OptimizedVolume& costs, View view, const DisparityRange& range,
                    cv::Mat& disparity) {
  CV_Assert(costs.disparities() == range.count);
  disparity.create(costs.height(), costs.width(), CV_32FC1);
  std::vector<cv::Range> inside;
  for (int x = 0; x < costs.width(); ++x) {
    inside.push_back(insideDisparities(view, range, x, costs.width()));
  }
  tbb::parallel_for(tbb::blocked_range<int>(0, costs.height()), [&](const auto& rows) {
    for (int y = rows.begin(); y != rows.end(); ++y) {
      HWY_DYNAMIC_DISPATCH(findWinners)
      (costs.row(y), range.count, inside.data(), costs.width(), static_cast<float>(range.min),
       range.invalid(), disparity.ptr<float>(y));
    }
  });
}

}  // namespace cbmv
#endif  // HWY_ONCE
