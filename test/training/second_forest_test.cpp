#include "training/second_forest.h"

#include <limits>
#include <memory>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "forest/forest_file.h"
#include "selection/confidence_features.h"
#include "selection/selection_features.h"
#include "support/random_images.h"
#include "support/rendered_data_set.h"
#include "support/temporary_folder.h"

#include "cbmv_stereo/stereo_matcher.h"

namespace cbmv::test {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::Each;
using testing::ElementsAre;
using testing::Gt;
using testing::HasSubstr;
using testing::Le;

TEST(CrossFittingGroups, HaveAboutTheSameSize) {
  EXPECT_THAT(crossFittingGroups({"A", "B", "C", "D", "E", "F"}, 3), ElementsAre(0, 0, 1, 1, 2, 2));
  EXPECT_THAT(crossFittingGroups({"A", "B", "C", "D", "E"}, 2), ElementsAre(0, 0, 0, 1, 1));
  EXPECT_THAT(crossFittingGroups({"A", "B"}, 1), ElementsAre(0, 0));
}

TEST(CrossFittingGroups, KeepRelativesTogether) {
  EXPECT_THAT(crossFittingGroups({"A", "Piano", "PianoL", "X"}, 2), ElementsAre(0, 0, 0, 1));
  EXPECT_THAT(crossFittingGroups({"Piano", "PianoL"}, 2), ElementsAre(0, 0));
}

TEST(CrossFittingGroups, AreFewerWithFewScenes) {
  EXPECT_THAT(crossFittingGroups({"A", "B"}, 3), ElementsAre(0, 1));
  EXPECT_THAT(crossFittingGroups({"A"}, 3), ElementsAre(0));
  EXPECT_THAT(crossFittingGroups({}, 3), ElementsAre());
}

/// Rendered scenes and a fast training.
class SecondForest : public testing::Test {
 protected:
  SecondForest() {
    for (int s = 0; s < 3; ++s) {
      writeScene(folder_.file("S" + std::to_string(s)), renderScene(120, 90, s));
    }
    scenes_ = chooseScenes({DataSet::open("middlebury_v3:" + folder_.file(""))}, {});
    options_.boosting.trees = 6;
    options_.boosting.depth = 3;
    options_.pixels_per_scene = 2000;
    options_.search.levels = 0;
    options_.second.pixels_per_scene = 4000;
    options_.second.confidence.trees = 8;
    options_.second.selection.trees = 8;
    options_.second.matching[0].search.levels = 0;
    options_.second.matching[0].sgm.iterations = 1;
    options_.second.matching[0].surface.enabled = false;
  }

  Forest train() {
    lines_.clear();
    return trainOnScenes(scenes_, options_,
                         [&](const std::string& line) { lines_.push_back(line); });
  }

  const TemporaryFolder folder_;
  std::vector<SceneReference> scenes_;
  TrainingOptions options_;
  std::vector<std::string> lines_;
};

void expectSame(const ConfidenceForest& found, const ConfidenceForest& expected) {
  EXPECT_EQ(found.feature_names, expected.feature_names);
  EXPECT_EQ(found.trees.size(), expected.trees.size());
  EXPECT_EQ(found.sigma_px, expected.sigma_px);
  EXPECT_EQ(found.sigma_roughness_bounds, expected.sigma_roughness_bounds);
  EXPECT_EQ(found.record.samples, expected.record.samples);
}

TEST_F(SecondForest, HasBothForestsAndTheModelOfTheDeviation) {
  const Forest forest = train();
  ASSERT_NE(forest.confidence, nullptr);
  ASSERT_NE(forest.selection, nullptr);
  EXPECT_EQ(forest.confidence->feature_names, confidenceFeatureNames());
  EXPECT_EQ(forest.selection->feature_names, selectionFeatureNames());
  EXPECT_EQ(forest.confidence->trees.size(), 8U);
  EXPECT_EQ(forest.confidence->sigma_px.size(), 40U);
  EXPECT_THAT(forest.confidence->sigma_px, Each(AllOf(Gt(0.0), Le(1.0))));
  const auto& bounds = forest.confidence->sigma_roughness_bounds;
  EXPECT_TRUE(0 < bounds[0] && bounds[0] < bounds[1] && bounds[1] < bounds[2]);
  EXPECT_LT(forest.confidence->record.held_out_log_loss, 0.69);
  EXPECT_THAT(lines_, Contains(HasSubstr("without group 2 of 2")));
  EXPECT_THAT(lines_, Contains(HasSubstr("selection forest: 8 trees")));
}

TEST_F(SecondForest, IsTheSameFromItsFile) {
  const Forest forest = train();
  writeForest(forest, folder_.file("two.forest"));
  const Forest read = readForest(folder_.file("two.forest"));
  ASSERT_NE(read.confidence, nullptr);
  ASSERT_NE(read.selection, nullptr);
  expectSame(*read.confidence, *forest.confidence);
  expectSame(*read.selection, *forest.selection);
}

/// The forest separates right from wrong on an unseen scene.
TEST_F(SecondForest, KnowsWhereAnotherMapIsRight) {
  const auto forest = std::make_shared<Forest>(train());
  const RenderedScene scene = renderScene(120, 90, 9);
  StereoOptions options = options_.second.matching[0];
  options.range = {0, 30};
  const StereoResult result = StereoMatcher(forest, options).match(scene.left, scene.right);
  ASSERT_EQ(result.disparity_sigma.size(), scene.left.size());
  const cv::Mat right = cv::abs(result.disparity - scene.truth) <= 1.0;
  const double of_right = cv::mean(result.confidence, right)[0];
  const double of_wrong = cv::mean(result.confidence, ~right)[0];
  EXPECT_GT(of_right, of_wrong + 0.08);
}

TEST_F(SecondForest, DependsOnTheSeedOnly) {
  const auto train_with = [&](std::size_t threads, std::uint64_t seed) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    options_.seed = seed;
    return forestChecksum(train());
  };
  const std::string checksum = train_with(1, 1);
  EXPECT_EQ(train_with(2, 1), checksum);
  EXPECT_NE(train_with(2, 2), checksum);
}

TEST_F(SecondForest, LearnsFromNoMorePixelsThanAllowed) {
  options_.max_samples = 3000;
  const Forest forest = train();
  EXPECT_EQ(forest.confidence->record.samples, 3000);
  EXPECT_LE(forest.selection->record.samples, kSources * 3000);
  EXPECT_THAT(forest.confidence->record.options, HasSubstr("pixels per scene 1000"));
}

/// Half of the truth is 2 px off. These errors must not affect the standard deviation.
TEST_F(SecondForest, LearnsTheDeviationOfInliers) {
  for (int s = 0; s < 3; ++s) {
    RenderedScene scene = renderScene(120, 90, s);
    for (int y = 0; y < scene.truth.rows; y += 2) {
      scene.truth.row(y) += 2;
    }
    writeScene(folder_.file("S" + std::to_string(s)), scene);
  }
  const Forest forest = train();
  ASSERT_NE(forest.confidence, nullptr);
  EXPECT_THAT(forest.confidence->sigma_px, Each(Le(1.0)));
}

TEST_F(SecondForest, LearnsNoSelectionFromSparseTruth) {
  for (int s = 0; s < 3; ++s) {
    RenderedScene scene = renderScene(120, 90, s);
    scene.truth.colRange(0, 80).setTo(std::numeric_limits<float>::infinity());
    writeScene(folder_.file("S" + std::to_string(s)), scene);
  }
  const Forest forest = train();
  EXPECT_NE(forest.confidence, nullptr);
  EXPECT_EQ(forest.selection, nullptr);
  EXPECT_THAT(lines_, Contains(HasSubstr("the truth covers 33 % of the pixels, expected 50 %")));
}

/// A wall of noise, where every disparity with known truth is correct.
RenderedScene makeWall(std::uint32_t seed) {
  constexpr int kDisparity = 5;
  RenderedScene scene;
  scene.left = makeGray({120, 90}, Content::kNoise, seed);
  cv::copyMakeBorder(scene.left.colRange(kDisparity, 120), scene.right, 0, 0, 0, kDisparity,
                     cv::BORDER_REPLICATE);
  scene.truth = cv::Mat(90, 120, CV_32FC1, cv::Scalar(kDisparity));
  scene.truth.colRange(0, 30).setTo(std::numeric_limits<float>::infinity());
  scene.visible = scene.truth == kDisparity;
  return scene;
}

TEST_F(SecondForest, TakesRightAndWrongDisparities) {
  for (int s = 0; s < 3; ++s) {
    writeScene(folder_.file("S" + std::to_string(s)), makeWall(s));
  }
  const Forest forest = train();
  EXPECT_EQ(forest.confidence, nullptr);
  EXPECT_THAT(lines_, Contains(HasSubstr("no correct or no wrong disparities")));
}

TEST_F(SecondForest, TakesTwoGroups) {
  scenes_.erase(scenes_.begin() + 1, scenes_.end());
  const Forest forest = train();
  EXPECT_EQ(forest.confidence, nullptr);
  EXPECT_EQ(forest.selection, nullptr);
  EXPECT_THAT(lines_, Contains(HasSubstr("at least two groups")));
}

TEST_F(SecondForest, IsOfObliviousForestsWhereItIsEnabled) {
  options_.second.enabled = false;
  EXPECT_EQ(train().confidence, nullptr);
  options_.second.enabled = true;
  options_.kind = ForestKind::kRandomForest;
  options_.random_forest.trees = 3;
  options_.random_forest.samples_per_leaf = 100;
  EXPECT_EQ(train().confidence, nullptr);
}

}  // namespace
}  // namespace cbmv::test
