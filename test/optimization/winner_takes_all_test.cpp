#include "cbmv_stereo/optimization/winner_takes_all.h"

#include <gtest/gtest.h>

#include "support/random_images.h"
#include "support/simd_targets.h"

namespace cbmv::test {
namespace {

float naiveWinner(const OptimizedVolume& costs, View view, const DisparityRange& range, int y,
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
  for (const int max_cost : {0, 3, 255, 65535}) {  // small ones: many ties
    const OptimizedVolume costs = makeCosts(shape, content, max_cost, 4);
    onEverySimdTarget([&, v = view, all = shape] {
      cv::Mat disparity;
      winnerTakesAll(costs, v, all.range, disparity);
      expectMap<float>(disparity, all.size(),
                       [&](int y, int x) { return naiveWinner(costs, v, all.range, y, x); });
    });
  }
}

float naiveWinnerAcross(const OptimizedVolume& left_costs, const DisparityRange& range, int y,
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

TEST_P(WinnerTakesAll, AcrossEqualsNaiveOne) {
  const auto [shape, view, content] = GetParam();
  if (view == View::kRight) {
    return;  // the costs are always of the left view
  }
  for (const int max_cost : {0, 3, 255, 65535}) {
    const OptimizedVolume costs = makeCosts(shape, content, max_cost, 4);
    onEverySimdTarget([&, all = shape] {
      cv::Mat disparity;
      PerThread<RowAcross> scratch;
      winnerTakesAllAcross(costs, all.range, scratch, disparity);
      expectMap<float>(disparity, all.size(),
                       [&](int y, int x) { return naiveWinnerAcross(costs, all.range, y, x); });
    });
  }
}

INSTANTIATE_TEST_SUITE_P(Shapes, WinnerTakesAll, allCases());

}  // namespace
}  // namespace cbmv::test
