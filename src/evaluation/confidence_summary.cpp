#include "evaluation/confidence_summary.h"

#include <algorithm>

namespace cbmv {
namespace {

double weightOf(const SceneScore& score, bool weighted) { return weighted ? score.weight : 1.0; }

OperatingPoint meanAtDensity(const std::vector<SceneScore>& scores, PixelSums SceneScore::*sums,
                             bool weighted, double density) {
  OperatingPoint mean{kNotMeasured, density, 0.0, 0.0};
  double weights = 0.0;
  for (const SceneScore& score : scores) {
    const OperatingPoint point = atDensity((score.*sums).confidence, density);
    mean.bad_1 += weightOf(score, weighted) * point.bad_1;
    mean.bad_3 += weightOf(score, weighted) * point.bad_3;
    weights += weightOf(score, weighted);
  }
  mean.bad_1 /= weights;
  mean.bad_3 /= weights;
  return mean;
}

}  // namespace

std::optional<ConfidenceSummary> summarizeConfidence(const std::vector<SceneScore>& scores,
                                                     PixelSums SceneScore::*sums, bool weighted,
                                                     const std::optional<double>& density) {
  PixelSums all;
  for (const SceneScore& score : scores) {
    addSums(score.*sums, weightOf(score, weighted), all);
  }
  const ConfidenceProfile& pooled = all.confidence;
  if (pooled.bins.empty()) {
    return std::nullopt;
  }
  ConfidenceSummary summary;
  summary.reliability = reliability(pooled);
  summary.calibration_error = calibrationError(pooled);
  summary.recalibration = fitRecalibration(pooled);
  summary.recalibrated_error = calibrationError(recalibrate(pooled, summary.recalibration));
  summary.sigma_scale = fitSigmaScale(all.sigma);
  std::transform(kMinConfidences.begin(), kMinConfidences.end(), summary.operating_points.begin(),
                 [&](double threshold) { return operatingPoint(pooled, threshold); });
  if (density) {
    summary.at_density = atDensity(pooled, *density);
    summary.at_density_each_scene = meanAtDensity(scores, sums, weighted, *density);
  }
  return summary;
}

}  // namespace cbmv
