#include "evaluation/recalibration.h"

#include <algorithm>

#include "selection/confidence_scaling.h"

#include "cbmv_stereo/parameters.h"

namespace cbmv {
namespace {

using Bin = ConfidenceProfile::Bin;

constexpr int kIterations = 50;
constexpr double kLargestStep = 2.0;
constexpr double kSmallestCurvature = 1e-9;  // per pixel

double logOdds(const Bin& bin) { return logOddsOf(bin.confidence / bin.pixels); }

double inRange(double value, const char* parameter) {
  const Parameter range = findParameter(parameter);
  return std::clamp(value, range.lowest, range.highest);
}

/// First and second derivatives of the log-likelihood.
struct Derivatives {
  double scale = 0.0, shift = 0.0;
  double scale_scale = 0.0, scale_shift = 0.0, shift_shift = 0.0;
};

Derivatives derivativesAt(const ConfidenceProfile& profile, const Recalibration& map) {
  Derivatives sum;
  for (const Bin& bin : profile.bins) {
    if (bin.pixels <= 0.0) {
      continue;
    }
    const double x = logOdds(bin);
    const double p = scaledConfidence(x, map.scale, map.shift);
    const double surplus = bin.pixels * (1.0 - p) - bin.wrong;
    const double weight = bin.pixels * p * (1.0 - p);
    sum.scale += surplus * x;
    sum.shift += surplus;
    sum.scale_scale += weight * x * x;
    sum.scale_shift += weight * x;
    sum.shift_shift += weight;
  }
  return sum;
}

}  // namespace

Recalibration fitRecalibration(const ConfidenceProfile& profile) {
  Recalibration map;
  for (int i = 0; i < kIterations; ++i) {  // Newton's method
    const Derivatives d = derivativesAt(profile, map);
    const double determinant = d.scale_scale * d.shift_shift - d.scale_shift * d.scale_shift;
    if (!(determinant > kSmallestCurvature * profile.pixels * profile.pixels)) {
      return {};
    }
    const double scale = (d.shift_shift * d.scale - d.scale_shift * d.shift) / determinant;
    const double shift = (d.scale_scale * d.shift - d.scale_shift * d.scale) / determinant;
    map.scale += std::clamp(scale, -kLargestStep, kLargestStep);
    map.shift += std::clamp(shift, -kLargestStep, kLargestStep);
  }
  return {inRange(map.scale, "confidence_scale"), inRange(map.shift, "confidence_shift")};
}

std::optional<double> fitSigmaScale(const SigmaCoverage& coverage) {
  if (!(coverage.inliers > 0.0)) {
    return std::nullopt;
  }
  return inRange(coverage.ratioQuantile(kOneSigmaShare), "sigma_scale");
}

ConfidenceProfile recalibrate(const ConfidenceProfile& profile, const Recalibration& map) {
  ConfidenceProfile result = profile;
  std::fill(result.bins.begin(), result.bins.end(), Bin{});
  result.squared_error = 0.0;
  for (const Bin& bin : profile.bins) {
    if (bin.pixels <= 0.0) {
      continue;
    }
    const double p = scaledConfidence(logOdds(bin), map.scale, map.shift);
    Bin moved = bin;
    moved.confidence = bin.pixels * p;
    result.bins[confidenceBin(p)].add(moved, 1.0);
    result.squared_error += bin.wrong * p * p + (bin.pixels - bin.wrong) * (1.0 - p) * (1.0 - p);
  }
  return result;
}

}  // namespace cbmv
