#include "evaluation/recalibration.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace cbmv {
namespace {

using Bin = ConfidenceProfile::Bin;

constexpr int kIterations = 50;
constexpr double kLargestStep = 2.0;
constexpr double kSmallestCurvature = 1e-9;  // per pixel
constexpr double kLowestScale = 0.1;         // ranges of the parameters
constexpr double kHighestScale = 10.0;
constexpr double kHighestShift = 10.0;

double logOdds(const Bin& bin) {
  constexpr double kOutermost = 0.5 / 255.0;  // as MapSelector
  const double mean = std::clamp(bin.confidence / bin.pixels, kOutermost, 1.0 - kOutermost);
  return std::log(mean / (1.0 - mean));
}

double probability(const Recalibration& map, double log_odds) {
  return 1.0 / (1.0 + std::exp(-(map.scale * log_odds + map.shift)));
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
    const double p = probability(map, x);
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
  return {std::clamp(map.scale, kLowestScale, kHighestScale),
          std::clamp(map.shift, -kHighestShift, kHighestShift)};
}

ConfidenceProfile recalibrate(const ConfidenceProfile& profile, const Recalibration& map) {
  ConfidenceProfile result = profile;
  std::fill(result.bins.begin(), result.bins.end(), Bin{});
  result.squared_error = 0.0;
  for (const Bin& bin : profile.bins) {
    if (bin.pixels <= 0.0) {
      continue;
    }
    const double p = probability(map, logOdds(bin));
    Bin& target =
        result.bins[std::min(static_cast<std::size_t>(p * kConfidenceBins), kConfidenceBins - 1)];
    target.pixels += bin.pixels;
    target.confidence += bin.pixels * p;
    target.wrong += bin.wrong;
    target.bad_1 += bin.bad_1;
    target.bad_3 += bin.bad_3;
    result.squared_error += bin.wrong * p * p + (bin.pixels - bin.wrong) * (1.0 - p) * (1.0 - p);
  }
  return result;
}

}  // namespace cbmv
