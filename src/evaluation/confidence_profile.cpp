#include "evaluation/confidence_profile.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "evaluation/map_checks.h"

namespace cbmv {
namespace {

using Bin = ConfidenceProfile::Bin;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t kBinsPerCalibrationBin = kConfidenceBins / kCalibrationBins;

/// The ten bins of the reliability diagram.
std::array<Bin, kCalibrationBins> wideBins(const ConfidenceProfile& profile) {
  std::array<Bin, kCalibrationBins> wide{};
  for (std::size_t b = 0; b < profile.bins.size(); ++b) {
    wide[b / kBinsPerCalibrationBin].add(profile.bins[b], 1.0);
  }
  return wide;
}

OperatingPoint pointOf(double min_confidence, const Bin& kept, double pixels) {
  return {min_confidence, 100.0 * kept.pixels / pixels, 100.0 * kept.bad_1 / kept.pixels,
          100.0 * kept.bad_3 / kept.pixels};
}

}  // namespace

void ConfidenceProfile::Bin::add(const Bin& bin, double share) {
  pixels += share * bin.pixels;
  confidence += share * bin.confidence;
  wrong += share * bin.wrong;
  bad_1 += share * bin.bad_1;
  bad_3 += share * bin.bad_3;
}

std::size_t confidenceBin(double confidence) {
  constexpr double kTolerance = 1e-4;  // bins; 0.7 as a float is below 0.7
  const auto bin = static_cast<std::size_t>(confidence * kConfidenceBins + kTolerance);
  return std::min(bin, kConfidenceBins - 1);
}

ConfidenceProfile profileConfidence(const cv::Mat& disparity, const cv::Mat& confidence,
                                    const cv::Mat& truth, const cv::Mat& mask, float invalid,
                                    float correct_px) {
  requireMap(disparity, "disparity", CV_32FC1, disparity.size());
  requireMap(confidence, "confidence", CV_32FC1, disparity.size());
  requireMap(truth, "truth", CV_32FC1, disparity.size());
  requireMap(mask, "mask", CV_8UC1, disparity.size());
  ConfidenceProfile profile;
  profile.bins.resize(kConfidenceBins);
  bool is_probability = true;
  forCountedPixels(truth, mask, [&](int y, int x) {
    profile.pixels += 1.0;
    const float d = disparity.at<float>(y, x);
    const float given = confidence.at<float>(y, x);
    const float c = std::isnan(given) ? 0.0F : given;
    is_probability = is_probability && c >= 0.0F && c <= 1.0F;
    if (!is_probability || !hasDisparity(d, invalid)) {
      return;
    }
    const float error = std::abs(d - truth.at<float>(y, x));
    const double correct = error > correct_px ? 0.0 : 1.0;
    profile.bins[confidenceBin(c)].add(
        {1.0, c, 1.0 - correct, error > 1.0F ? 1.0 : 0.0, error > 3.0F ? 1.0 : 0.0}, 1.0);
    profile.squared_error += (c - correct) * (c - correct);
  });
  if (!is_probability) {
    profile.bins.clear();
  }
  return profile;
}

void addProfile(const ConfidenceProfile& scene, double weight, ConfidenceProfile& sum) {
  const bool is_first = sum.pixels == 0.0;
  const double share = weight / scene.pixels;
  sum.pixels += weight;
  if (scene.bins.empty() || (sum.bins.empty() && !is_first)) {
    sum.bins.clear();
    return;
  }
  sum.bins.resize(kConfidenceBins);
  sum.squared_error += share * scene.squared_error;
  for (std::size_t b = 0; b < kConfidenceBins; ++b) {
    sum.bins[b].add(scene.bins[b], share);
  }
}

double calibrationError(const ConfidenceProfile& profile) {
  if (profile.bins.empty()) {
    return kNan;
  }
  double gaps = 0.0;
  for (const Bin& bin : wideBins(profile)) {
    gaps += std::abs(bin.confidence - (bin.pixels - bin.wrong));
  }
  return gaps / profile.pixels;
}

double brierScore(const ConfidenceProfile& profile) {
  return profile.bins.empty() ? kNan : profile.squared_error / profile.pixels;
}

std::array<CalibrationBin, kCalibrationBins> reliability(const ConfidenceProfile& profile) {
  std::array<CalibrationBin, kCalibrationBins> diagram;
  const std::array<Bin, kCalibrationBins> wide = wideBins(profile);
  std::transform(wide.begin(), wide.end(), diagram.begin(), [&](const Bin& bin) {
    return CalibrationBin{profile.bins.empty() ? 0.0 : 100.0 * bin.pixels / profile.pixels,
                          bin.confidence / bin.pixels, 1.0 - bin.wrong / bin.pixels};
  });
  return diagram;
}

OperatingPoint operatingPoint(const ConfidenceProfile& profile, double min_confidence) {
  if (profile.bins.empty()) {
    return {min_confidence, kNan, kNan, kNan};
  }
  const double begin = std::round(1e6 * min_confidence * kConfidenceBins) / 1e6;  // in bins
  Bin kept;
  for (std::size_t b = 0; b < kConfidenceBins; ++b) {
    kept.add(profile.bins[b], std::clamp(static_cast<double>(b) + 1.0 - begin, 0.0, 1.0));
  }
  return pointOf(min_confidence, kept, profile.pixels);
}

OperatingPoint atDensity(const ConfidenceProfile& profile, double percent) {
  if (profile.bins.empty()) {
    return {kNan, percent, kNan, kNan};
  }
  double missing = percent / 100.0 * profile.pixels;
  Bin kept;
  double begin = kConfidenceBins;
  for (auto bin = profile.bins.rbegin(); bin != profile.bins.rend() && missing > 0.0; ++bin) {
    const double share = bin->pixels > missing ? missing / bin->pixels : 1.0;
    kept.add(*bin, share);
    missing -= share * bin->pixels;
    begin -= share;
  }
  kept.add({missing, 0.0, missing, missing, missing}, 1.0);
  return pointOf(std::max(begin, 0.0) / kConfidenceBins, kept, profile.pixels);
}

}  // namespace cbmv
