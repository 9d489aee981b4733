#include "pipeline/disparity_estimator.h"

#include <algorithm>
#include <memory>
#include <utility>

#include <gtest/gtest.h>

#include "support/random_forest.h"
#include "support/random_images.h"
#include "volume/volume_builder.h"

#include "cbmv_stereo/stereo_matcher.h"

namespace cbmv::test {
namespace {

StereoOptions alignedOptions(const DisparityRange& range) {
  StereoOptions options;
  options.range = range;
  options.rectification.enabled = false;
  return options;
}

MatchingVolume buildVolume(const cv::Mat& left, const cv::Mat& right, const DisparityRange& range,
                           const Forest& forest) {
  MatchingVolume volume;
  VolumeBuilder().build(left, right, range, forest, ForestEvaluator(forest), volume);
  return volume;
}

bool equal(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && a.type() == b.type() &&
         (a.empty() || cv::norm(a, b, cv::NORM_INF) == 0);
}

/// Compares one object used for all shapes and settings with a new StereoMatcher for each.
TEST(DisparityEstimator, GivesWhatTheMatcherGivesWhateverCameBefore) {
  const auto forest = std::make_shared<Forest>(makeForest(8, 5, 3));
  DisparityEstimator estimator;
  for (const Shape& shape : awkwardShapes()) {
    const cv::Mat left = makeGray(shape.size(), Content::kPatches, 1);
    const cv::Mat right = makeGray(shape.size(), Content::kPatches, 2);
    for (const bool check : {true, false}) {
      StereoOptions options = alignedOptions(shape.range);
      options.refinement.left_right_check = check;
      MatchingVolume volume = buildVolume(left, right, shape.range, *forest);
      StereoResult result;
      estimator.estimate(left, right, options, std::move(volume), result);
      const StereoResult expected = StereoMatcher(forest, options).match(left, right);
      EXPECT_TRUE(equal(result.disparity, expected.disparity)) << shape;
      EXPECT_TRUE(equal(result.right_disparity, expected.right_disparity)) << shape;
      EXPECT_TRUE(equal(result.labels, expected.labels)) << shape;
      EXPECT_TRUE(equal(result.confidence, expected.confidence)) << shape;
      EXPECT_TRUE(equal(result.margin, expected.margin)) << shape;
      EXPECT_EQ(result.range.min, shape.range.min);
      EXPECT_EQ(result.range.count, shape.range.count);
    }
  }
}

TEST(DisparityEstimator, LeavesTheRightViewsVolume) {
  const Forest forest = makeForest(8, 5, 3);
  const DisparityRange range{-2, 9};
  const cv::Mat left = makeGray({31, 12}, Content::kPatches, 1);
  const cv::Mat right = makeGray({31, 12}, Content::kPatches, 2);
  const MatchingVolume original = buildVolume(left, right, range, forest);
  const auto volume_after = [&](bool check, bool optimize_right_view) {
    StereoOptions options = alignedOptions(range);
    options.refinement.left_right_check = check;
    options.refinement.optimize_right_view = optimize_right_view;
    MatchingVolume volume = original;
    StereoResult result;
    DisparityEstimator().estimate(left, right, options, std::move(volume), result);
    return volume;
  };
  MatchingVolume shifted = original;
  PerThread<std::vector<std::uint8_t>> rows;
  shiftToRightView(range, shifted, rows);
  const auto same = [](const MatchingVolume& a, const MatchingVolume& b) {
    return a.size() == b.size() && std::equal(a.row(0), a.row(0) + a.size(), b.row(0));
  };
  EXPECT_TRUE(same(volume_after(true, true), shifted));
  EXPECT_TRUE(same(volume_after(true, false), original));
  EXPECT_TRUE(same(volume_after(false, true), original));
}

}  // namespace
}  // namespace cbmv::test
