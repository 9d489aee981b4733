#include "evaluation/scene_score.h"

#include <cmath>
#include <limits>
#include <string>

#include <gtest/gtest.h>

#include "evaluation/disparity_error.h"
#include "evaluation/sparsification.h"
#include "support/error_text.h"

namespace cbmv {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

double metric(const MetricValues& values, const std::string& name) {
  for (std::size_t m = 0; m < kMetrics.size(); ++m) {
    if (name == kMetrics[m].name) {
      return values[m];
    }
  }
  ADD_FAILURE() << name;
  return 0.0;
}

StereoScene makeScene() {
  StereoScene scene;
  scene.name = "Scene";
  scene.truth = cv::Mat(2, 5, CV_32FC1, cv::Scalar(4));
  scene.truth.at<float>(1, 4) = std::numeric_limits<float>::quiet_NaN();
  scene.visible = (cv::Mat_<uchar>(2, 5) << 0, 255, 255, 255, 255, 0, 255, 255, 255, 0);
  scene.calibration.disparities = 20;
  return scene;
}

SceneMaps makeMaps() {
  SceneMaps maps;
  maps.disparity = (cv::Mat_<float>(2, 5) << 9, 4, 4.7F, 5.5F, 6.5F, 4, 7.5F, 8.5F, kInfinity, 4);
  maps.confidence =
      (cv::Mat_<float>(2, 5) << 0.9F, 0.8F, 0.7F, 0.6F, 0.5F, 0.4F, 0.3F, 0.2F, 0.1F, 0);
  maps.disparity_sigma = (cv::Mat_<float>(2, 5) << 1, 1, 0.5F, 1, 1, 1, 1, 1, 1, 1);
  maps.seconds = 2.0;
  return maps;
}

void expectMetrics(const MetricValues& values, const DisparityError& error,
                   const Sparsification& sparsification) {
  EXPECT_EQ(metric(values, "bad_0.5"), error.bad_05);
  EXPECT_EQ(metric(values, "bad_1"), error.bad_1);
  EXPECT_EQ(metric(values, "bad_2"), error.bad_2);
  EXPECT_EQ(metric(values, "bad_3"), error.bad_3);
  EXPECT_EQ(metric(values, "bad_4"), error.bad_4);
  EXPECT_EQ(metric(values, "d1"), error.d1);
  EXPECT_EQ(metric(values, "avg"), error.average_px);
  EXPECT_EQ(metric(values, "rms"), error.rms_px);
  EXPECT_EQ(metric(values, "a50"), error.a50_px);
  EXPECT_EQ(metric(values, "a90"), error.a90_px);
  EXPECT_EQ(metric(values, "a99"), error.a99_px);
  EXPECT_EQ(metric(values, "auc"), sparsification.auc);
  EXPECT_EQ(metric(values, "auc_optimal"), sparsification.auc_optimal);
}

TEST(SceneScore, HasTheMetricsOfVisibleAndOfAllPixels) {
  const StereoScene scene = makeScene();
  const SceneMaps maps = makeMaps();
  const SceneScore score = scoreScene(scene, maps);
  const cv::Mat everywhere(2, 5, CV_8UC1, cv::Scalar(255));
  EXPECT_EQ(score.scene, "Scene");
  for (const auto& [values, mask] :
       {std::make_pair(score.noc, scene.visible), std::make_pair(score.all, everywhere)}) {
    expectMetrics(values, evaluateDisparity(maps.disparity, scene.truth, mask, kInfinity),
                  sparsify(maps.disparity, maps.confidence, scene.truth, mask, kInfinity, 1.0F));
  }
  EXPECT_NEAR(metric(score.noc, "bad_0.5"), 600.0 / 7.0, 1e-12);
  EXPECT_NEAR(metric(score.all, "bad_0.5"), 700.0 / 9.0, 1e-12);
  EXPECT_NEAR(score.density, 800.0 / 9.0, 1e-12);
  EXPECT_EQ(score.seconds, 2.0);
  EXPECT_NEAR(score.ns_per_hypothesis, 2e9 / (10 * 20), 1e-3);
}

TEST(SceneScore, HasTheMetricsOfConfidenceAndSigma) {
  const StereoScene scene = makeScene();
  const SceneMaps maps = makeMaps();
  const SceneScore score = scoreScene(scene, maps);
  const ConfidenceProfile profile = profileConfidence(maps.disparity, maps.confidence, scene.truth,
                                                      scene.visible, kInfinity, 1.0F);
  EXPECT_EQ(metric(score.noc, "ece"), calibrationError(profile));
  EXPECT_EQ(metric(score.noc, "brier"), brierScore(profile));
  EXPECT_EQ(score.noc_sums.confidence.pixels, 7.0);
  EXPECT_EQ(score.all_sums.confidence.pixels, 9.0);
  // Inliers: the second and third pixel, with errors 0 and 0.7 px; for all pixels one more.
  EXPECT_NEAR(metric(score.noc, "sigma_1"), 50.0, 1e-12);
  EXPECT_NEAR(metric(score.all, "sigma_1"), 200.0 / 3.0, 1e-12);
  EXPECT_NEAR(metric(score.all, "sigma_2"), 100.0, 1e-12);
  EXPECT_NEAR(metric(score.noc, "sigma_rms"), 1.4 / std::sqrt(2.0), 1e-6);
}

TEST(SceneScore, CorrectIsWhatTheDataSetAllows) {
  const StereoScene scene = makeScene();
  const SceneMaps maps = makeMaps();
  const SceneScore score = scoreScene(scene, maps, {3.0, 1.0});
  const Sparsification sparsification =
      sparsify(maps.disparity, maps.confidence, scene.truth, scene.visible, kInfinity, 3.0F);
  EXPECT_EQ(metric(score.noc, "auc"), sparsification.auc);
  EXPECT_EQ(metric(score.noc, "ece"),
            calibrationError(profileConfidence(maps.disparity, maps.confidence, scene.truth,
                                               scene.visible, kInfinity, 3.0F)));
  EXPECT_EQ(metric(score.noc, "bad_1"), metric(scoreScene(scene, maps).noc, "bad_1"));
  // Inliers have errors of 0, 0.7, 1.5 and 2.5 px, and a sigma of 1, 0.5, 1 and 1 px.
  EXPECT_NEAR(metric(score.noc, "sigma_1"), 25.0, 1e-12);
  EXPECT_NEAR(metric(score.noc, "sigma_2"), 75.0, 1e-12);
}

/// Errors are scaled, so bad 2 equals the earlier bad 1. Confidence and sigma metrics do not
/// change.
TEST(SceneScore, ScaleIsOfErrors) {
  const StereoScene scene = makeScene();
  const SceneMaps maps = makeMaps();
  const cv::Mat disparity = maps.disparity.clone();
  const SceneScore once = scoreScene(scene, maps);
  const SceneScore twice = scoreScene(scene, maps, {1.0, 2.0});
  for (const auto& [small, large] : {std::make_pair(once.noc, twice.noc), {once.all, twice.all}}) {
    EXPECT_EQ(metric(large, "bad_1"), metric(small, "bad_0.5"));
    EXPECT_EQ(metric(large, "bad_2"), metric(small, "bad_1"));
    EXPECT_EQ(metric(large, "bad_4"), metric(small, "bad_2"));
    EXPECT_EQ(metric(large, "avg"), 2.0 * metric(small, "avg"));
    EXPECT_EQ(metric(large, "rms"), 2.0 * metric(small, "rms"));
    for (const char* same : {"auc", "auc_optimal", "ece", "brier", "sigma_1", "sigma_2"}) {
      EXPECT_EQ(metric(large, same), metric(small, same)) << same;
    }
  }
  EXPECT_EQ(twice.density, once.density);
  EXPECT_EQ(twice.ns_per_hypothesis, once.ns_per_hypothesis);
  EXPECT_EQ(maps.disparity.at<float>(0, 0), disparity.at<float>(0, 0));
}

TEST(SceneScore, HasTheCurvesOfVisiblePixels) {
  const StereoScene scene = makeScene();
  const SceneMaps maps = makeMaps();
  const SceneCurves curves = scoreScene(scene, maps).curves;
  const Sparsification sparsification =
      sparsify(maps.disparity, maps.confidence, scene.truth, scene.visible, kInfinity, 1.0F);
  ASSERT_EQ(curves.sparsification.size(), kKeptPercents.size());
  ASSERT_EQ(curves.sparsification_optimal.size(), kKeptPercents.size());
  for (std::size_t p = 0; p < kKeptPercents.size(); ++p) {
    const auto k = static_cast<std::size_t>(kKeptPercents[p] - 1);
    EXPECT_EQ(curves.sparsification[p], sparsification.bad[k]);
    EXPECT_EQ(curves.sparsification_optimal[p], sparsification.bad_optimal[k]);
  }
  const DisparityError error =
      evaluateDisparity(maps.disparity, scene.truth, scene.visible, kInfinity);
  EXPECT_EQ(curves.error_histogram,
            std::vector<double>(error.histogram.begin(), error.histogram.end()));
}

TEST(SceneScore, LeavesOpenWhatIsNotKnown) {
  SceneMaps maps = makeMaps();
  maps.confidence.release();
  maps.disparity_sigma.release();
  maps.seconds = kNotMeasured;
  const SceneScore score = scoreScene(makeScene(), maps);
  EXPECT_TRUE(std::isnan(metric(score.noc, "auc")));
  EXPECT_TRUE(std::isnan(metric(score.all, "auc_optimal")));
  for (std::size_t m = kErrorMetrics; m < kMetrics.size(); ++m) {
    EXPECT_TRUE(std::isnan(score.noc[m]) && std::isnan(score.all[m])) << kMetrics[m].name;
  }
  EXPECT_TRUE(score.noc_sums.confidence.bins.empty());
  EXPECT_TRUE(std::isnan(score.seconds));
  EXPECT_TRUE(std::isnan(score.ns_per_hypothesis));
  EXPECT_TRUE(score.curves.sparsification.empty() && score.curves.sparsification_optimal.empty());
  EXPECT_EQ(score.curves.error_histogram.size(), kErrorBins + 1);
}

TEST(SceneScore, RejectsASceneWithoutVisiblePixels) {
  StereoScene scene = makeScene();
  scene.visible = 128;
  EXPECT_TRUE(mentions(errorText([&] { scoreScene(scene, makeMaps()); }), {"no pixel"}));
}

TEST(SceneScore, MeansAreOverScenesAndByWeight) {
  SceneScore a;
  a.noc.fill(10.0);
  a.all.fill(20.0);
  a.density = 100.0;
  a.seconds = 1.0;
  a.ns_per_hypothesis = 8.0;
  SceneScore b = a;
  b.weight = 0.5;
  b.noc.fill(40.0);
  b.all.fill(80.0);
  b.density = 70.0;
  b.seconds = 4.0;
  const SceneScore mean = meanScore({a, b}, false);
  const SceneScore weighted = meanScore({a, b}, true);
  for (const std::size_t m : {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 14}) {  // not pooled
    EXPECT_NEAR(mean.noc[m], 25.0, 1e-12);
    EXPECT_NEAR(mean.all[m], 50.0, 1e-12);
    EXPECT_NEAR(weighted.noc[m], 20.0, 1e-12);
    EXPECT_NEAR(weighted.all[m], 40.0, 1e-12);
  }
  EXPECT_NEAR(mean.density, 85.0, 1e-12);
  EXPECT_NEAR(weighted.density, 90.0, 1e-12);
  EXPECT_NEAR(weighted.seconds, 2.0, 1e-12);
  EXPECT_NEAR(weighted.ns_per_hypothesis, 8.0, 1e-12);
  EXPECT_EQ(mean.scene, "mean");
  EXPECT_EQ(weighted.scene, "weighted mean");
}

/// Two scenes of different sizes whose calibration errors cancel: together they are calibrated,
/// although neither is.
TEST(SceneScore, CalibrationAndSigmaAreOfThePixelsOfAllScenes) {
  SceneScore sure;
  sure.noc_sums.confidence.bins.resize(kConfidenceBins);
  sure.noc_sums.confidence.pixels = 10.0;
  sure.noc_sums.confidence.bins[100] = {10.0, 5.0, 10.0, 10.0, 10.0};  // none is correct
  sure.noc_sums.sigma.pixels = 10.0;
  sure.noc_sums.sigma.addInliers(5.0, 1.0);
  SceneScore modest = sure;
  modest.noc_sums.confidence.pixels = 1000.0;
  modest.noc_sums.confidence.bins[100] = {1000.0, 500.0, 0.0, 0.0, 0.0};  // all are
  modest.noc_sums.sigma = {};
  modest.noc_sums.sigma.pixels = 1000.0;
  modest.noc_sums.sigma.addInliers(500.0, std::sqrt(2.0));
  modest.weight = 0.5;
  const SceneScore mean = meanScore({sure, modest}, false);
  EXPECT_NEAR(metric(mean.noc, "ece"), 0.0, 1e-12);
  EXPECT_NEAR(metric(mean.noc, "sigma_1"), 50.0, 1e-12);
  EXPECT_NEAR(metric(mean.noc, "sigma_2"), 100.0, 1e-12);
  EXPECT_NEAR(metric(mean.noc, "sigma_rms"), std::sqrt(1.5), 1e-12);
  const SceneScore weighted = meanScore({sure, modest}, true);
  EXPECT_NEAR(metric(weighted.noc, "ece"), 1.0 / 6.0, 1e-12);
  EXPECT_NEAR(metric(weighted.noc, "sigma_1"), 200.0 / 3.0, 1e-12);
}

}  // namespace
}  // namespace cbmv
