#include "evaluation/disparity_source.h"

#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <string>

#include <gtest/gtest.h>

#include "io/image_file.h"
#include "io/pfm.h"
#include "support/error_text.h"
#include "support/random_forest.h"
#include "support/rendered_stereo_scene.h"
#include "support/temporary_folder.h"

#include "cbmv_stereo/stereo_matcher.h"

namespace cbmv {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

TEST(MatchingSource, MatchesOverTheRangeOfTheScene) {
  const auto forest = std::make_shared<Forest>(test::makeForest(8, 4, 3));
  StereoOptions options;
  options.refinement.fill_mismatches = false;
  options.refinement.fill_occlusions = false;
  const DisparitySource source = matchingSource(forest, options);
  for (const int disparities : {20, 12}) {
    StereoScene scene = makeScene(1);
    scene.calibration.disparities = disparities;
    options.range = {0, disparities};
    StereoMatcher matcher(forest, options);
    StereoResult result = matcher.match(scene.left, scene.right);
    EXPECT_GT(cv::countNonZero(result.disparity == options.range.invalid()), 0);
    result.disparity.setTo(kInfinity, result.disparity == options.range.invalid());
    const SceneMaps maps = source(scene);
    EXPECT_TRUE(same(maps.disparity, result.disparity));
    EXPECT_TRUE(same(maps.confidence, result.confidence));
    EXPECT_GT(maps.seconds, 0.0);
  }
}

/// Each scene gets its own range.
TEST(MatchingSource, FindsARangeThatIsAutomatic) {
  StereoOptions options;
  options.range.count = 0;
  const auto forest = std::make_shared<Forest>(test::makeForest(8, 4, 3));
  const DisparitySource source = matchingSource(forest, options);
  for (const int width : {300, 150}) {
    const StereoScene scene = makeScene(1, {width, 100});
    StereoMatcher matcher(forest, options);
    const StereoResult result = matcher.match(scene.left, scene.right);
    EXPECT_GT(result.range.count, scene.calibration.disparities);
    EXPECT_TRUE(same(source(scene).disparity, toSceneMaps(result).disparity));
  }
}

/// Only the size of the images is used, so they have no pixels.
TEST(MatchingSource, TellsNeedAndPresenceOfMemory) {
  const DisparitySource source =
      matchingSource(std::make_shared<Forest>(test::makeForest(1, 1, 1)), {});
  StereoScene scene = makeScene(1);
  std::uint8_t no_pixels = 0;
  scene.left = scene.right = cv::Mat(65535, 65535, CV_8UC1, &no_pixels);
  scene.calibration.disparities = 4096;
  EXPECT_TRUE(mentions(errorText([&] { source(scene); }),
                       {"65535x65535", "4096 disparities need", "but the machine has"}));
}

TEST(MatchingSource, RejectsInconsistentOptions) {
  StereoOptions options;
  options.sgm.p1 = options.sgm.p2 + 1.0F;
  EXPECT_THROW(matchingSource(std::make_shared<Forest>(test::makeForest(1, 1, 1)), options), Error);
}

TEST(FileSource, ReadsWhatWriteMapsWrote) {
  const TemporaryFolder folder;
  const StereoScene scene = makeScene(2);
  SceneMaps maps;
  maps.disparity = scene.truth.clone();
  maps.disparity.at<float>(3, 3) = kInfinity;
  maps.confidence = cv::Mat(scene.truth.size(), CV_32FC1, cv::Scalar(0.25));
  maps.disparity_sigma = cv::Mat(scene.truth.size(), CV_32FC1, cv::Scalar(0.5));
  writeMaps(folder.file("maps"), scene, maps);
  SceneMaps read = fileSource(folder.file("maps"))(scene);
  EXPECT_TRUE(std::isnan(read.disparity.at<float>(3, 3)));
  maps.disparity.at<float>(3, 3) = 0.0F;
  read.disparity.at<float>(3, 3) = 0.0F;
  EXPECT_TRUE(same(read.disparity, maps.disparity));
  EXPECT_TRUE(same(read.confidence, maps.confidence));
  EXPECT_TRUE(same(read.disparity_sigma, maps.disparity_sigma));
  EXPECT_TRUE(std::isnan(read.seconds));
}

TEST(FileSource, ReadsIntegersWithoutConfidence) {
  const TemporaryFolder folder;
  const StereoScene scene = makeScene(2);
  cv::Mat integers(scene.truth.size(), CV_16UC1, cv::Scalar(640));
  integers.at<std::uint16_t>(0, 0) = 0;
  writeImage(folder.file("Scene.png"), integers);
  const SceneMaps maps = fileSource(folder.file(""))(scene);
  EXPECT_EQ(maps.disparity.at<float>(1, 1), 2.5F);
  EXPECT_TRUE(std::isnan(maps.disparity.at<float>(0, 0)));
  EXPECT_TRUE(maps.confidence.empty() && maps.disparity_sigma.empty());
}

TEST(FileSource, ExtensionsMayBeInUpperCase) {
  const TemporaryFolder folder;
  const StereoScene scene = makeScene(2);
  const cv::Mat words(scene.truth.size(), CV_16UC1, cv::Scalar(640));
  writeImage(folder.file("Scene.PNG"), words);
  EXPECT_EQ(fileSource(folder.file(""))(scene).disparity.at<float>(1, 1), 2.5F);
  writePfm(folder.file("Scene.PFM"), cv::Mat(scene.truth.size(), CV_32FC1, cv::Scalar(3)));
  EXPECT_EQ(fileSource(folder.file(""))(scene).disparity.at<float>(1, 1), 3.0F);
}

TEST(FileSource, NamesTheFileThatIsWrong) {
  const TemporaryFolder folder;
  const StereoScene scene = makeScene(2);
  const auto error = [&](const std::string& file) {
    std::string text = errorText([&] { fileSource(folder.file(""))(scene); });
    EXPECT_TRUE(mentions(text, {file}));
    return text;
  };
  EXPECT_TRUE(mentions(error("Scene.pfm"), {"no such file"}));
  writePfm(folder.file("Scene.pfm"), cv::Mat::zeros(3, 4, CV_32FC1));
  EXPECT_TRUE(mentions(error("Scene.pfm"), {"4x3", "64x32"}));
  writePfm(folder.file("Scene.pfm"), scene.truth);
  writePfm(folder.file("Scene_confidence.pfm"), cv::Mat::zeros(3, 4, CV_32FC1));
  EXPECT_TRUE(mentions(error("Scene_confidence.pfm"), {"4x3", "64x32"}));
  writePfm(folder.file("Scene_confidence.pfm"), scene.truth);
  writePfm(folder.file("Scene_sigma.pfm"), cv::Mat::zeros(3, 4, CV_32FC1));
  EXPECT_TRUE(mentions(error("Scene_sigma.pfm"), {"4x3", "64x32"}));
}

}  // namespace
}  // namespace cbmv
