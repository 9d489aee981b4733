#include "optimization/winner_takes_all.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <iterator>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#ifndef CBMV_OPTIMIZATION_WINNER_TAKES_ALL_ONCE
#define CBMV_OPTIMIZATION_WINNER_TAKES_ALL_ONCE
namespace cbmv {
namespace {

/// Indices [start, end) of the disparities of column x whose match is inside of the other image,
/// which is `width` pixels wide. Empty if there are none.
cv::Range insideDisparities(View view, const DisparityRange& range, int x, int width) {
  // The disparities that match the first and the last column of the other image.
  const int lowest = view == View::kLeft ? x - (width - 1) : -x;
  const int highest = view == View::kLeft ? x : width - 1 - x;
  const int start = std::clamp(lowest - range.min, 0, range.count);
  const int end = std::clamp(highest - range.min + 1, start, range.count);
  return {start, end};
}

}  // namespace
}  // namespace cbmv
#endif  // CBMV_OPTIMIZATION_WINNER_TAKES_ALL_ONCE

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "optimization/winner_takes_all.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

#include "optimization/cost_vectors-inl.h"

HWY_BEFORE_NAMESPACE();
namespace cbmv {
namespace HWY_NAMESPACE {
namespace {

/// Loads `count` costs. The other lanes get the largest number.
HWY_INLINE hn::Vec<LineTag<std::uint16_t>> loadCosts(const std::uint16_t* costs, int count) {
  const LineTag<std::uint16_t> tag;
  const auto values = hn::LoadU(tag, costs);
  return count >= static_cast<int>(hn::Lanes(tag))
             ? values
             : hn::IfThenElse(hn::FirstN(tag, count), values, hn::Set(tag, 0xffff));
}

/// The lowest of `count` costs in all lanes. The largest number if there are none.
HWY_INLINE hn::Vec<LineTag<std::uint16_t>> findLowest(const std::uint16_t* costs, int count) {
  const LineTag<std::uint16_t> tag;
  const auto lanes = static_cast<int>(hn::Lanes(tag));
  auto lowest = hn::Set(tag, 0xffff);
  for (int i = 0; i < count; i += lanes) {
    lowest = hn::Min(lowest, loadCosts(costs + i, count - i));
  }
  return hn::MinOfLanes(tag, lowest);
}

/// Index of the first of the lowest of `count` ≥ 1 costs.
int findCheapest(const std::uint16_t* costs, int count) {
  const LineTag<std::uint16_t> tag;
  const auto lanes = static_cast<int>(hn::Lanes(tag));
  const auto lowest = findLowest(costs, count);
  int first = 0;
  while (hn::AllFalse(tag, hn::Eq(hn::LoadU(tag, costs + first), lowest))) {
    first += lanes;
  }
  const auto found = hn::Eq(hn::LoadU(tag, costs + first), lowest);
  return first + static_cast<int>(hn::FindFirstTrue(tag, found));
}

/// For h in [0, count): if costs[h] is lower than lowest[h], sets lowest[h] to it and winners[h] to
/// the hypothesis `first` + h. Reads and writes whole vectors.
void takeCheaper(const std::uint16_t* costs, int first, int count, std::uint16_t* lowest,
                 std::uint16_t* winners) {
  const LineTag<std::uint16_t> tag;
  const auto lanes = static_cast<int>(hn::Lanes(tag));
  for (int h = 0; h < count; h += lanes) {
    const auto cost = loadCosts(costs + h, count - h);
    const auto before = hn::LoadU(tag, lowest + h);
    const auto after = hn::Min(before, cost);
    const auto hypotheses = countFrom(tag, static_cast<std::uint16_t>(first + h));
    const auto is_cheapest = hn::And(hn::Eq(after, cost), hn::FirstN(tag, count - h));
    hn::StoreU(after, tag, lowest + h);
    hn::StoreU(hn::IfThenElse(is_cheapest, hypotheses, hn::LoadU(tag, winners + h)), tag,
               winners + h);
  }
}

/// Finds the winners of a row of the right image from the costs of the left view. It runs from
/// right to left, so that the smallest hypothesis that matches a right pixel comes last. `lowest`
/// and `winners` have the right pixels from right to left, the order in which the hypotheses of a
/// left pixel match them.
void findRightWinners(const std::uint16_t* costs, const DisparityRange& range, int columns,
                      std::uint16_t* lowest, std::uint16_t* winners) {
  for (int x = columns - 1; x >= 0; --x) {
    const cv::Range inside = insideDisparities(View::kLeft, range, x, columns);
    const int match = columns - 1 - x + range.min + inside.start;
    takeCheaper(costs + static_cast<std::ptrdiff_t>(x) * range.count + inside.start, inside.start,
                inside.size(), lowest + match, winners + match);
  }
}

/// Computes the margins of a row of the left view, as winnerMargins.
void findMargins(const std::uint16_t* costs, const DisparityRange& range, int columns,
                 const float* winners, std::uint16_t* margins) {
  for (int x = 0; x < columns; ++x, costs += range.count) {
    margins[x] = kNoMargin;
    if (winners[x] == range.invalid()) {
      continue;
    }
    const int winner = static_cast<int>(winners[x]) - range.min;
    const cv::Range inside = insideDisparities(View::kLeft, range, x, columns);
    const int after = winner + 2;
    const auto second =
        hn::GetLane(hn::Min(findLowest(costs + inside.start, winner - 1 - inside.start),
                            findLowest(costs + after, inside.end - after)));
    if (second != kNoMargin) {
      margins[x] = static_cast<std::uint16_t>(second - costs[winner]);
    }
  }
}

/// The disparity of lowest cost for each pixel of a row.
void findWinners(const std::uint16_t* costs, View view, const DisparityRange& range, int columns,
                 float* winners) {
  for (int x = 0; x < columns; ++x, costs += range.count) {
    const cv::Range inside = insideDisparities(view, range, x, columns);
    const int start = inside.start;
    winners[x] =
        inside.empty()
            ? range.invalid()
            : static_cast<float>(range.min + start + findCheapest(costs + start, inside.size()));
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
HWY_EXPORT(findRightWinners);
HWY_EXPORT(findMargins);

constexpr std::uint16_t kNone = 0xffff;  // no winner

}  // namespace

void winnerTakesAll(const AggregatedVolume& costs, View view, const DisparityRange& range,
                    cv::Mat& disparity) {
  CV_Assert(costs.disparities() == range.count);
  disparity.create(costs.height(), costs.width(), CV_32FC1);
  tbb::parallel_for(tbb::blocked_range<int>(0, costs.height()), [&](const auto& rows) {
    for (int y = rows.begin(); y != rows.end(); ++y) {
      HWY_DYNAMIC_DISPATCH(findWinners)
      (costs.row(y), view, range, costs.width(), disparity.ptr<float>(y));
    }
  });
}

void winnerMargins(const AggregatedVolume& costs, const DisparityRange& range,
                   const cv::Mat& winners, cv::Mat& margin) {
  CV_Assert(costs.disparities() == range.count);
  margin.create(winners.size(), CV_16UC1);
  tbb::parallel_for(0, costs.height(), [&](int y) {
    HWY_DYNAMIC_DISPATCH(findMargins)
    (costs.row(y), range, costs.width(), winners.ptr<float>(y), margin.ptr<std::uint16_t>(y));
  });
}

void rightWinners(const AggregatedVolume& left_costs, const DisparityRange& range,
                  PerThread<RightWinnersRow>& scratch, cv::Mat& right_disparity) {
  CV_Assert(left_costs.disparities() == range.count);
  const int width = left_costs.width();
  right_disparity.create(left_costs.height(), width, CV_32FC1);
  const std::size_t size = width + kReadableBytesBeyond / sizeof(std::uint16_t);
  scratch.prepare([size](RightWinnersRow& row) {
    row.lowest.resize(size);
    row.winners.resize(size);
  });
  tbb::parallel_for(0, left_costs.height(), [&](int y) {
    RightWinnersRow& row = scratch.local();
    std::fill(row.lowest.begin(), row.lowest.end(), 0xffff);
    std::fill(row.winners.begin(), row.winners.end(), kNone);
    HWY_DYNAMIC_DISPATCH(findRightWinners)
    (left_costs.row(y), range, width, row.lowest.data(), row.winners.data());
    std::transform(row.winners.begin(), row.winners.begin() + width,
                   std::make_reverse_iterator(right_disparity.ptr<float>(y) + width),
                   [&range](std::uint16_t winner) {
                     return winner == kNone ? range.invalid()
                                            : static_cast<float>(range.min + winner);
                   });
  });
}

}  // namespace cbmv
#endif  // HWY_ONCE
