#include "evaluation/scene_score.h"

#include "evaluation/disparity_error.h"
#include "evaluation/sparsification.h"

#include "cbmv_stereo/error.h"

namespace cbmv {
namespace {

constexpr float kNone = std::numeric_limits<float>::infinity();

/// Maps and truth, scaled for the thresholds.
struct Comparison {
  SceneMaps maps;
  cv::Mat truth;
  float correct_px;
};

Comparison compare(const StereoScene& scene, const SceneMaps& maps, const ScoreOptions& options) {
  Comparison scaled{maps, cv::Mat(), static_cast<float>(options.correct_px * options.scale)};
  scene.truth.convertTo(scaled.truth, -1, options.scale);
  for (cv::Mat* map : {&scaled.maps.disparity, &scaled.maps.disparity_sigma}) {
    cv::Mat product;
    map->convertTo(product, -1, options.scale);
    *map = product;
  }
  return scaled;
}

/// All measures over the pixels of one mask.
struct PixelScore {
  DisparityError error;
  Sparsification sparsification{{}, {}, kNotMeasured, kNotMeasured};
  PixelSums sums;
};

PixelScore scorePixels(const Comparison& compared, const cv::Mat& mask) {
  const SceneMaps& maps = compared.maps;
  PixelScore score;
  score.error = evaluateDisparity(maps.disparity, compared.truth, mask, kNone);
  if (!maps.confidence.empty()) {
    score.sparsification =
        sparsify(maps.disparity, maps.confidence, compared.truth, mask, kNone, compared.correct_px);
    score.sums.confidence = profileConfidence(maps.disparity, maps.confidence, compared.truth, mask,
                                              kNone, compared.correct_px);
  }
  if (!maps.disparity_sigma.empty()) {
    score.sums.sigma = coverSigma(maps.disparity, maps.disparity_sigma, compared.truth, mask, kNone,
                                  compared.correct_px);
  }
  return score;
}

/// Indices of the last metrics in kMetrics.
constexpr std::size_t kEce = 13;
constexpr std::size_t kSigma1 = 15;
constexpr std::size_t kSigma2 = 16;
constexpr std::size_t kSigmaRms = 17;

/// Sets the metrics that are computed over the pixels of all scenes together.
void setPooled(const PixelSums& sums, MetricValues& values) {
  values[kEce] = calibrationError(sums.confidence);
  values[kSigma1] = sums.sigma.withinOne();
  values[kSigma2] = sums.sigma.withinTwo();
  values[kSigmaRms] = sums.sigma.rms();
}

MetricValues metricValues(const PixelScore& score) {
  const DisparityError& error = score.error;
  MetricValues values = {error.bad_05,
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
                         score.sparsification.auc,
                         score.sparsification.auc_optimal,
                         0.0,
                         brierScore(score.sums.confidence)};
  setPooled(score.sums, values);
  return values;
}

/// Samples a curve over 1 … 100 percent at kKeptPercents.
std::vector<double> thinned(const std::vector<double>& curve) {
  std::vector<double> points;
  for (const int percent : kKeptPercents) {
    if (!curve.empty()) {
      points.push_back(curve[static_cast<std::size_t>(percent - 1)]);
    }
  }
  return points;
}

/// Adds `share` times every value of `score`.
void add(const SceneScore& score, double share, SceneScore& sum) {
  for (std::size_t m = 0; m < kMetrics.size(); ++m) {
    sum.noc[m] += share * score.noc[m];
    sum.all[m] += share * score.all[m];
  }
  addSums(score.noc_sums, share, sum.noc_sums);
  addSums(score.all_sums, share, sum.all_sums);
  sum.density += share * score.density;
  sum.seconds += share * score.seconds;
  sum.ns_per_hypothesis += share * score.ns_per_hypothesis;
}

}  // namespace

void addSums(const PixelSums& scene, double weight, PixelSums& sum) {
  addProfile(scene.confidence, weight, sum.confidence);
  addCoverage(scene.sigma, weight, sum.sigma);
}

bool operator==(const ScoreOptions& a, const ScoreOptions& b) {
  return a.correct_px == b.correct_px && a.scale == b.scale;
}

SceneScore scoreScene(const StereoScene& scene, const SceneMaps& maps,
                      const ScoreOptions& options) {
  const cv::Mat everywhere(scene.truth.size(), CV_8UC1, cv::Scalar(255));
  const Comparison compared = compare(scene, maps, options);
  const PixelScore noc = scorePixels(compared, scene.visible);
  const PixelScore all = scorePixels(compared, everywhere);
  if (noc.error.pixels == 0) {
    throw Error(
        "no pixel that both cameras see has a known true disparity, expected at least one. Check "
        "the ground truth");
  }
  SceneScore score;
  score.scene = scene.name;
  score.noc = metricValues(noc);
  score.all = metricValues(all);
  score.noc_sums = noc.sums;
  score.all_sums = all.sums;
  score.curves = {thinned(noc.sparsification.bad),
                  thinned(noc.sparsification.bad_optimal),
                  {noc.error.histogram.begin(), noc.error.histogram.end()}};
  score.density = all.error.density;
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
  setPooled(mean.noc_sums, mean.noc);
  setPooled(mean.all_sums, mean.all);
  return mean;
}

}  // namespace cbmv
