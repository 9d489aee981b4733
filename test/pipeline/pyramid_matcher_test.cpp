#include "pipeline/pyramid_matcher.h"

#include <gtest/gtest.h>

#include "evaluation/rendered_scene.h"
#include "pipeline/disparity_estimator.h"
#include "pipeline/windowed_estimator.h"
#include "support/forest_fixture.h"
#include "support/rendered_stereo_scene.h"
#include "volume/volume_builder.h"
#include "volume/windowed_volume_builder.h"

#include "cbmv_stereo/parameters.h"
#include "cbmv_stereo/stereo_matcher.h"

namespace cbmv {
namespace {

const Forest kForest = makeForestFixture();

StereoOptions optionsOf(const char* preset, int disparities, int levels) {
  StereoOptions options;
  readPreset(std::string(CBMV_SOURCE_DIR "/config/") + preset + ".yaml", options);
  options.range = {0, disparities};
  options.rectification.enabled = false;
  options.search.levels = levels;
  return options;
}

/// With the whole range in every tile, each windowed stage gives the same result as the dense one.
TEST(WindowedEstimator, AnExhaustiveSpaceGivesTheDenseResult) {
  const RenderedScene scene = renderScene(150, 90, 4);
  const ForestEvaluator evaluator(kForest);
  for (const char* preset : {"quality", "balanced", "realtime", "kitti"}) {
    SCOPED_TRACE(preset);
    StereoOptions options = optionsOf(preset, 33, 0);
    options.surface.enabled = false;
    MatchingVolume dense;
    VolumeBuilder().build(scene.left, scene.right, options.range, kForest, evaluator, dense);
    StereoResult expected;
    DisparityEstimator().estimate(scene.left, scene.right, options, std::move(dense), expected);
    SearchSpace space;
    space.buildExhaustive(scene.left.rows, scene.left.cols, options.range);
    WindowedMatchingVolume volume;
    WindowedVolumeBuilder().build(scene.left, scene.right, space, kForest, evaluator, volume);
    StereoResult found;
    WindowedEstimator().estimate(scene.left, scene.right, {}, options, space, volume, found);
    EXPECT_TRUE(same(found.disparity, expected.disparity));
    EXPECT_TRUE(same(found.confidence, expected.confidence));
    EXPECT_TRUE(same(found.margin, expected.margin));
    EXPECT_TRUE(same(found.labels, expected.labels));
    EXPECT_TRUE(same(found.right_disparity, expected.right_disparity));
  }
}

StereoResult match(const cv::Mat& left, const cv::Mat& right, const StereoOptions& options) {
  StereoMatcher matcher(std::make_shared<const Forest>(kForest), options);
  return matcher.match(left, right);
}

double wrongShare(const StereoResult& result, const RenderedScene& scene) {
  int wrong = 0;
  int known = 0;
  for (int y = 0; y < scene.truth.rows; ++y) {
    for (int x = 0; x < scene.truth.cols; ++x) {
      if (scene.visible.at<uchar>(y, x) != 0) {
        ++known;
        wrong += std::abs(result.disparity.at<float>(y, x) - scene.truth.at<float>(y, x)) > 1;
      }
    }
  }
  return static_cast<double>(wrong) / known;
}

TEST(PyramidMatcher, IsAsRightAsTheExhaustiveSearch) {
  const RenderedScene scene = renderScene(320, 240, 2);
  for (const char* preset : {"quality", "realtime"}) {
    const double full = wrongShare(match(scene.left, scene.right, optionsOf(preset, 48, 0)), scene);
    for (const int levels : {1, 2, 3}) {
      const StereoResult result = match(scene.left, scene.right, optionsOf(preset, 48, levels));
      EXPECT_LE(wrongShare(result, scene), full + 0.01) << preset << ", levels " << levels;
    }
  }
}

TEST(PyramidMatcher, DependsNeitherOnThreadsNorOnEarlierPairs) {
  const RenderedScene scene = renderScene(230, 150, 5);
  StereoOptions options = optionsOf("quality", 40, 2);
  options.threads = 1;
  const cv::Mat expected = match(scene.left, scene.right, options).disparity;
  options.threads = 4;
  StereoMatcher matcher(std::make_shared<const Forest>(kForest), options);
  const RenderedScene other = renderScene(260, 140, 6);
  matcher.match(other.left, other.right);
  EXPECT_TRUE(same(matcher.match(scene.left, scene.right).disparity, expected));
}

TEST(PyramidMatcher, SmallImagesHaveFewerLevels) {
  StereoOptions options;
  options.search.levels = 3;
  EXPECT_EQ(searchLevels({640, 480}, options), 3);
  EXPECT_EQ(searchLevels({640, 128}, options), 2);
  EXPECT_EQ(searchLevels({640, 64}, options), 1);
  EXPECT_EQ(searchLevels({60, 480}, options), 0);
  options.search.levels = 0;
  EXPECT_EQ(searchLevels({640, 480}, options), 0);
}

/// Sizes and ranges that leave almost nothing at the coarse levels.
TEST(PyramidMatcher, TakesAwkwardSizesAndRanges) {
  for (const cv::Size size : {cv::Size(65, 67), cv::Size(131, 66), cv::Size(97, 129)}) {
    const RenderedScene scene = renderScene(size.width, size.height, 1);
    for (const DisparityRange range :
         {DisparityRange{0, 1}, DisparityRange{-20, 7}, DisparityRange{-9, 30},
          DisparityRange{0, size.width}, DisparityRange{size.width - 3, 3}}) {
      StereoOptions options = optionsOf("quality", 1, 3);
      options.range = range;
      const StereoResult result = match(scene.left, scene.right, options);
      EXPECT_EQ(result.disparity.size(), size);
      EXPECT_EQ(result.range.count, range.count);
    }
  }
}

}  // namespace
}  // namespace cbmv
