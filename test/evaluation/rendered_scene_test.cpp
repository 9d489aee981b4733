#include "evaluation/rendered_scene.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "data_sets/visible_in_both.h"

namespace cbmv {
namespace {

RenderOptions withoutDisturbance() {
  RenderOptions options;
  options.noise_sigma = 0.0;
  options.right_gain = 1.0;
  options.right_offset = 0.0;
  return options;
}

/// Fraction of the visible pixels whose gray value at (x, y) is similar to that of their match in
/// the right image.
double partThatMatches(const RenderedScene& scene, double dy) {
  int alike = 0;
  int counted = 0;
  for (int y = 4; y < scene.left.rows - 4; ++y) {
    for (int x = 0; x < scene.left.cols; ++x) {
      const double x_right = x - scene.truth.at<float>(y, x);
      if (scene.visible.at<uchar>(y, x) == 255 && x_right < scene.right.cols - 1) {
        const int column = static_cast<int>(x_right);
        const cv::Mat pair = scene.right(cv::Rect(column, y + static_cast<int>(dy), 2, 1));
        const double a = x_right - column;
        const double value = (1.0 - a) * pair.at<uchar>(0, 0) + a * pair.at<uchar>(0, 1);
        ++counted;
        alike += std::abs(value - scene.left.at<uchar>(y, x)) <= 16.0 ? 1 : 0;
      }
    }
  }
  return static_cast<double>(alike) / counted;
}

// Linear interpolation misses waves of 4 px by up to a third of their amplitude and mixes two
// surfaces at depth edges. Hence the tolerance and 90 %.
TEST(RenderedScene, TruthLeadsToTheSameTexture) {
  for (int seed = 0; seed < 4; ++seed) {
    const RenderedScene scene = renderScene(203, 151, seed, withoutDisturbance());
    EXPECT_GT(partThatMatches(scene, 0.0), 0.9);
    EXPECT_LT(partThatMatches(scene, 2.0), 0.6);
  }
}

TEST(RenderedScene, AVerticalOffsetMovesTheRightImage) {
  RenderOptions options = withoutDisturbance();
  options.vertical_offset = 2.0;
  EXPECT_GT(partThatMatches(renderScene(203, 151, 1, options), 2.0), 0.9);
}

TEST(RenderedScene, VisibilityFollowsFromTheTruth) {
  const RenderedScene scene = renderScene(203, 151, 1);
  const cv::Mat derived = visibleInBoth(scene.truth);
  // The derived map differs by up to one column at object borders.
  EXPECT_LT(cv::countNonZero(derived != scene.visible), 0.02 * 203 * 151);
  EXPECT_LT(cv::countNonZero(scene.visible), 0.99 * 203 * 151);
}

TEST(RenderedScene, HoldsDisparitiesOfAboutTwoTo25) {
  for (int seed = 0; seed < 8; ++seed) {
    double lowest = 0.0;
    double highest = 0.0;
    cv::minMaxLoc(renderScene(121, 91, seed).truth, &lowest, &highest);
    EXPECT_GT(lowest, 1.5);
    EXPECT_LT(lowest, 3.0);
    EXPECT_GT(highest, 10.0);
    EXPECT_LT(highest, 25.5);
  }
}

TEST(RenderedScene, IsTheSameEveryTime) {
  const RenderedScene a = renderScene(64, 48, 5);
  const RenderedScene b = renderScene(64, 48, 5);
  EXPECT_EQ(cv::norm(a.left, b.left, cv::NORM_INF), 0.0);
  EXPECT_EQ(cv::norm(a.right, b.right, cv::NORM_INF), 0.0);
  EXPECT_GT(cv::norm(a.left, renderScene(64, 48, 6).left, cv::NORM_INF), 0.0);
}

}  // namespace
}  // namespace cbmv
