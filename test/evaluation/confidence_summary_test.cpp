#include "evaluation/confidence_summary.h"

#include <cmath>

#include <gtest/gtest.h>

namespace cbmv {
namespace {

/// A scene whose pixels all have the same confidence; `bad_…`: fractions above 1 and 3 px.
SceneScore makeScene(double pixels, std::size_t bin, double bad_1, double bad_3, double weight) {
  SceneScore score;
  score.weight = weight;
  ConfidenceProfile& profile = score.all_sums.confidence;
  profile.pixels = pixels;
  profile.bins.resize(kConfidenceBins);
  profile.bins[bin] = {pixels, pixels * static_cast<double>(bin) / kConfidenceBins, pixels * bad_1,
                       pixels * bad_1, pixels * bad_3};
  return score;
}

/// A scene with confidence 0.8, and a larger one with 0.4.
std::vector<SceneScore> twoScenes() {
  return {makeScene(10.0, 160, 0.1, 0.0, 1.0), makeScene(1000.0, 80, 0.5, 0.2, 0.5)};
}

TEST(ConfidenceSummary, PointsAreOfThePixelsOfAllScenes) {
  const auto summary = summarizeConfidence(twoScenes(), &SceneScore::all_sums, false, std::nullopt);
  ASSERT_TRUE(summary);
  EXPECT_FALSE(summary->at_density || summary->at_density_each_scene);
  EXPECT_EQ(summary->operating_points[1].min_confidence, 0.3);
  EXPECT_NEAR(summary->operating_points[1].density, 100.0, 1e-9);
  EXPECT_NEAR(summary->operating_points[1].bad_1, 30.0, 1e-9);
  EXPECT_NEAR(summary->operating_points[1].bad_3, 10.0, 1e-9);
  EXPECT_NEAR(summary->operating_points[2].density, 50.0, 1e-9);
  EXPECT_NEAR(summary->operating_points[2].bad_1, 10.0, 1e-9);
  EXPECT_NEAR(summary->reliability[8].pixels, 50.0, 1e-9);
  EXPECT_NEAR(summary->reliability[4].correct, 0.5, 1e-9);
}

TEST(ConfidenceSummary, ADensityHasOneThresholdOrOnePerScene) {
  const auto summary = summarizeConfidence(twoScenes(), &SceneScore::all_sums, false, 50.0);
  ASSERT_TRUE(summary && summary->at_density && summary->at_density_each_scene);
  EXPECT_NEAR(summary->at_density->bad_1, 10.0, 1e-9);  // only the scene with confidence 0.8
  EXPECT_NEAR(summary->at_density->min_confidence, 0.8, 1e-9);
  EXPECT_NEAR(summary->at_density_each_scene->bad_1, 30.0, 1e-9);  // half of each
  EXPECT_NEAR(summary->at_density_each_scene->bad_3, 10.0, 1e-9);
  EXPECT_TRUE(std::isnan(summary->at_density_each_scene->min_confidence));
}

TEST(ConfidenceSummary, HasTheWeightsOfTheScenes) {
  const auto summary = summarizeConfidence(twoScenes(), &SceneScore::all_sums, true, 100.0);
  ASSERT_TRUE(summary);
  EXPECT_NEAR(summary->operating_points[2].density, 200.0 / 3.0, 1e-9);
  EXPECT_NEAR(summary->at_density->bad_1, 70.0 / 3.0, 1e-9);
  EXPECT_NEAR(summary->at_density_each_scene->bad_1, 70.0 / 3.0, 1e-9);
}

TEST(ConfidenceSummary, SigmaScaleHasTheWeightsOfTheScenes) {
  std::vector<SceneScore> scenes = twoScenes();
  EXPECT_FALSE(summarizeConfidence(scenes, &SceneScore::all_sums, true, std::nullopt)->sigma_scale);
  scenes[0].all_sums.sigma.pixels = 10.0;
  scenes[0].all_sums.sigma.addInliers(10.0, 1.0);
  scenes[1].all_sums.sigma.pixels = 1000.0;
  scenes[1].all_sums.sigma.addInliers(1000.0, 2.0);
  EXPECT_NEAR(*summarizeConfidence(scenes, &SceneScore::all_sums, true, std::nullopt)->sigma_scale,
              2.0, 1.0 / 16);
  EXPECT_NEAR(*summarizeConfidence(scenes, &SceneScore::all_sums, false, std::nullopt)->sigma_scale,
              2.0, 1.0 / 16);
  scenes[1].weight = 0.4;
  EXPECT_NEAR(*summarizeConfidence(scenes, &SceneScore::all_sums, true, std::nullopt)->sigma_scale,
              1.0, 1.0 / 16);
}

TEST(ConfidenceSummary, IsNotThereUnlessAllScenesHaveOne) {
  EXPECT_FALSE(summarizeConfidence({}, &SceneScore::all_sums, false, 50.0));
  EXPECT_FALSE(summarizeConfidence(twoScenes(), &SceneScore::noc_sums, false, 50.0));
  std::vector<SceneScore> scenes = twoScenes();
  scenes.emplace_back();
  EXPECT_FALSE(summarizeConfidence(scenes, &SceneScore::all_sums, false, 50.0));
}

}  // namespace
}  // namespace cbmv
