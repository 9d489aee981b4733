#include "cbmv_stereo/evaluation/scene_score.h"

#include "cbmv_stereo/error.h"
#include "cbmv_stereo/evaluation/disparity_error.h"
#include "cbmv_stereo/evaluation/sparsification.h"

namespace cbmv {
namespace {

constexpr float kNone = std::numeric_limits<float>::infinity();

/// Without curves, and areas that are not measured, where the confidence is not known.
Sparsification sparsifyIfKnown(const StereoScene& scene, const SceneMaps& maps,
                               const cv::Mat& mask) {
  return maps.confidence.empty()
             ? Sparsification{{}, {}, kNotMeasured, kNotMeasured}
             : sparsify(maps.disparity, maps.confidence, scene.truth, mask, kNone);
}

MetricValues metricValues(const DisparityError& error, const Sparsification& sparsification) {
  return {error.bad_05,
          error.bad_1,
          error.bad_2,
          error.bad_3,
          error.bad_4,
          error.d1,
          error.average_px,
          error.rms_px,
          error.a50_px,
          error.a90_px,
          error.a99_px,
          sparsification.auc,
          sparsification.auc_optimal};
}

/// The points at kKeptPercents of a curve over 1 … 100 percent.
std::vector<double> thinned(const std::vector<double>& curve) {
  std::vector<double> points;
  for (const int percent : kKeptPercents) {
    if (!curve.empty()) {
      points.push_back(curve[static_cast<std::size_t>(percent - 1)]);
    }
  }
  return points;
}

/// Adds `share` of every number of `score`.
void add(const SceneScore& score, double share, SceneScore& sum) {
  for (std::size_t m = 0; m < kMetrics.size(); ++m) {
    sum.noc[m] += share * score.noc[m];
    sum.all[m] += share * score.all[m];
  }
  sum.density += share * score.density;
  sum.seconds += share * score.seconds;
  sum.ns_per_hypothesis += share * score.ns_per_hypothesis;
}

}  // namespace

SceneScore scoreScene(const StereoScene& scene, const SceneMaps& maps) {
  const cv::Mat everywhere(scene.truth.size(), CV_8UC1, cv::Scalar(255));
  const DisparityError noc = evaluateDisparity(maps.disparity, scene.truth, scene.visible, kNone);
  const DisparityError all = evaluateDisparity(maps.disparity, scene.truth, everywhere, kNone);
  if (noc.pixels == 0) {
    throw Error("no pixel that both cameras see has a known true disparity");
  }
  SceneScore score;
  score.scene = scene.name;
  const Sparsification sparsification = sparsifyIfKnown(scene, maps, scene.visible);
  score.noc = metricValues(noc, sparsification);
  score.all = metricValues(all, sparsifyIfKnown(scene, maps, everywhere));
  score.curves = {thinned(sparsification.bad_1),
                  thinned(sparsification.bad_1_optimal),
                  {noc.histogram.begin(), noc.histogram.end()}};
  score.density = all.density;
  score.seconds = maps.seconds;
  score.ns_per_hypothesis =
      1e9 * maps.seconds / static_cast<double>(scene.truth.total()) / scene.calibration.disparities;
  return score;
}

SceneScore meanScore(const std::vector<SceneScore>& scores, bool weighted) {
  double weights = 0.0;
  for (const SceneScore& score : scores) {
    weights += weighted ? score.weight : 1.0;
  }
  SceneScore mean;
  mean.scene = weighted ? "weighted mean" : "mean";
  mean.seconds = 0.0;
  mean.ns_per_hypothesis = 0.0;
  for (const SceneScore& score : scores) {
    add(score, (weighted ? score.weight : 1.0) / weights, mean);
  }
  return mean;
}

}  // namespace cbmv
