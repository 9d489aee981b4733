#include "optimization/winner_takes_all.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "support/random_images.h"
#include "support/simd_targets.h"

namespace cbmv::test {
namespace {

float naiveWinner(const AggregatedVolume& costs, View view, const DisparityRange& range, int y,
                  int x) {
  float winner = range.invalid();
  int lowest = 1 << 20;
  for (int i = 0; i < range.count; ++i) {
    const int match = matchingColumn(view, x, range.min + i);
    if (match >= 0 && match < costs.width() && costs.pixel(y, x)[i] < lowest) {
      lowest = costs.pixel(y, x)[i];
      winner = static_cast<float>(range.min + i);
    }
  }
  return winner;
}

class WinnerTakesAll : public testing::TestWithParam<Case> {};

TEST_P(WinnerTakesAll, EqualsNaiveOne) {
  const auto [shape, view, content] = GetParam();
  for (const int max_cost : {0, 3, 255, 65535}) {  // small ones cause many ties
    const AggregatedVolume costs = makeCosts(shape, content, max_cost, 4);
    onEverySimdTarget([&, v = view, all = shape] {
      cv::Mat disparity;
      winnerTakesAll(costs, v, all.range, disparity);
      expectMap<float>(disparity, all.size(),
                       [&](int y, int x) { return naiveWinner(costs, v, all.range, y, x); });
    });
  }
}

std::uint16_t naiveMargin(const AggregatedVolume& costs, const DisparityRange& range, int y,
                          int x) {
  const float winner = naiveWinner(costs, View::kLeft, range, y, x);
  int lowest = 65535;
  int second = 65535;
  for (int i = 0; i < range.count; ++i) {
    const int d = range.min + i;
    const int match = matchingColumn(View::kLeft, x, d);
    if (match < 0 || match >= costs.width()) {
      continue;
    }
    int& best = std::abs(static_cast<float>(d) - winner) > 1 ? second : lowest;
    best = std::min<int>(best, costs.pixel(y, x)[i]);
  }
  return winner == range.invalid() || second == 65535 ? kNoMargin
                                                      : static_cast<std::uint16_t>(second - lowest);
}

TEST_P(WinnerTakesAll, MarginEqualsNaiveOne) {
  const auto [shape, view, content] = GetParam();
  if (view == View::kRight) {
    return;  // margins exist for the left view only
  }
  for (const int max_cost : {0, 3, 255, 65535}) {
    const AggregatedVolume costs = makeCosts(shape, content, max_cost, 4);
    onEverySimdTarget([&, all = shape] {
      cv::Mat winners;
      cv::Mat margin;
      winnerTakesAll(costs, View::kLeft, all.range, winners);
      winnerMargins(costs, all.range, winners, margin);
      expectMap<std::uint16_t>(margin, all.size(),
                               [&](int y, int x) { return naiveMargin(costs, all.range, y, x); });
    });
  }
}

float naiveRightWinner(const AggregatedVolume& left_costs, const DisparityRange& range, int y,
                       int x) {
  float winner = range.invalid();
  int lowest = 1 << 20;
  for (int d = range.min; d <= range.max(); ++d) {
    const int left = x + d;
    if (left >= 0 && left < left_costs.width() &&
        left_costs.pixel(y, left)[d - range.min] < lowest) {
      lowest = left_costs.pixel(y, left)[d - range.min];
      winner = static_cast<float>(d);
    }
  }
  return winner;
}

TEST_P(WinnerTakesAll, RightWinnersEqualNaiveOnes) {
  const auto [shape, view, content] = GetParam();
  if (view == View::kRight) {
    return;  // costs always belong to the left view
  }
  for (const int max_cost : {0, 3, 255, 65535}) {
    const AggregatedVolume costs = makeCosts(shape, content, max_cost, 4);
    onEverySimdTarget([&, all = shape] {
      cv::Mat disparity;
      PerThread<RightWinnersRow> scratch;
      rightWinners(costs, all.range, scratch, disparity);
      expectMap<float>(disparity, all.size(),
                       [&](int y, int x) { return naiveRightWinner(costs, all.range, y, x); });
    });
  }
}

INSTANTIATE_TEST_SUITE_P(Shapes, WinnerTakesAll, allCases());

}  // namespace
}  // namespace cbmv::test
