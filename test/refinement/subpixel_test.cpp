#include "refinement/subpixel.h"

#include <cmath>

#include <gtest/gtest.h>

#include "optimization/winner_takes_all.h"
#include "support/random_images.h"

namespace cbmv::test {
namespace {

double naiveSubpixel(const AggregatedVolume& costs, View view, const DisparityRange& range, int y,
                     int x, float disparity) {
  if (disparity == range.invalid() || disparity != std::floor(disparity)) {
    return disparity;
  }
  const int d = static_cast<int>(disparity);
  for (const int neighbor : {d - 1, d + 1}) {
    const int match = matchingColumn(view, x, neighbor);
    if (neighbor < range.min || neighbor > range.max() || match < 0 || match >= costs.width()) {
      return disparity;
    }
  }
  const double before = costs.pixel(y, x)[d - 1 - range.min];
  const double here = costs.pixel(y, x)[d - range.min];
  const double after = costs.pixel(y, x)[d + 1 - range.min];
  if (here > before || here > after || (here == before && here == after)) {
    return disparity;
  }
  return d - (after - before) / (2 * (after - 2 * here + before));
}

void expectNaive(const AggregatedVolume& costs, View view, const Shape& shape,
                 const cv::Mat& before) {
  cv::Mat after = before.clone();
  refineSubpixel(costs, view, shape.range, after);
  expectMap<float>(
      after, shape.size(),
      [&](int y, int x) {
        return naiveSubpixel(costs, view, shape.range, y, x, before.at<float>(y, x));
      },
      1e-5);
}

class Subpixel : public testing::TestWithParam<Case> {};

TEST_P(Subpixel, EqualsNaiveParabolaAtWinners) {
  const auto [shape, view, content] = GetParam();
  for (const int max_cost : {0, 2, 5355, 65535}) {  // small ones cause many equal costs
    const AggregatedVolume costs = makeCosts(shape, content, max_cost, 15);
    cv::Mat winners;
    winnerTakesAll(costs, view, shape.range, winners);
    expectNaive(costs, view, shape, winners);
  }
}

TEST_P(Subpixel, LeavesPixelsWithoutMinimum) {
  const auto [shape, view, content] = GetParam();
  const AggregatedVolume costs = makeCosts(shape, content, 3, 16);
  cv::Mat disparity = makeDisparity(shape, content, 7, 17);
  expectNaive(costs, view, shape, disparity);
  disparity += 0.25F;
  expectNaive(costs, view, shape, disparity);
}

INSTANTIATE_TEST_SUITE_P(Shapes, Subpixel, allCases());

TEST(Subpixel, FindsTheMinimumOfAParabola) {
  AggregatedVolume costs(1, 9, 5);
  for (int x = 0; x < 9; ++x) {
    for (int i = 0; i < 5; ++i) {
      costs.pixel(0, x)[i] =
          static_cast<std::uint16_t>((4 * i - 9) * (4 * i - 9));  // minimum at 2.25
    }
  }
  cv::Mat disparity(1, 9, CV_32FC1, 2.0F);
  refineSubpixel(costs, View::kLeft, {0, 5}, disparity);
  EXPECT_FLOAT_EQ(disparity.at<float>(0, 2), 2.0F);  // d = 3 has no match here
  EXPECT_FLOAT_EQ(disparity.at<float>(0, 3), 2.25F);
}

}  // namespace
}  // namespace cbmv::test
