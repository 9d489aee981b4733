#include "evaluation/sigma_coverage.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "evaluation/map_checks.h"

namespace cbmv {
namespace {

double ratio(double part, double whole) {
  return whole > 0.0 ? part / whole : std::numeric_limits<double>::quiet_NaN();
}

double percentWithin(const SigmaCoverage& coverage, std::size_t sigmas) {
  const double* const begin = coverage.bins.data();
  const double* const end = begin + sigmas * SigmaCoverage::kBinsPerSigma;
  return 100.0 * ratio(std::accumulate(begin, end, 0.0), coverage.inliers);
}

}  // namespace

void SigmaCoverage::addInliers(double count, double ratio) {
  const double end = std::ceil(std::min(ratio * kBinsPerSigma, double{kBins}));
  inliers += count;
  squared_sum += count * ratio * ratio;
  bins[end < 1.0 ? 0 : static_cast<std::size_t>(end) - 1] += count;
}

double SigmaCoverage::ratioQuantile(double share) const {
  if (!(inliers > 0.0)) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  double below = 0.0;
  std::size_t b = 0;
  while (b + 1 < kBins && below + bins[b] < share * inliers) {
    below += bins[b++];
  }
  const double part =
      bins[b] > 0.0 ? std::clamp((share * inliers - below) / bins[b], 0.0, 1.0) : 0.0;
  return (static_cast<double>(b) + part) / kBinsPerSigma;
}

double SigmaCoverage::withinOne() const { return percentWithin(*this, 1); }

double SigmaCoverage::withinTwo() const { return percentWithin(*this, 2); }

double SigmaCoverage::rms() const { return std::sqrt(ratio(squared_sum, inliers)); }

SigmaCoverage coverSigma(const cv::Mat& disparity, const cv::Mat& sigma, const cv::Mat& truth,
                         const cv::Mat& mask, float invalid, float inlier_px) {
  requireMap(disparity, "disparity", CV_32FC1, disparity.size());
  requireMap(sigma, "disparity_sigma", CV_32FC1, disparity.size());
  requireMap(truth, "truth", CV_32FC1, disparity.size());
  requireMap(mask, "mask", CV_8UC1, disparity.size());
  SigmaCoverage coverage;
  forCountedPixels(truth, mask, [&](int y, int x) {
    coverage.pixels += 1.0;
    const float d = disparity.at<float>(y, x);
    const float s = sigma.at<float>(y, x);
    const float error = std::abs(d - truth.at<float>(y, x));
    if (!hasDisparity(d, invalid) || error > inlier_px || !std::isfinite(s) || s <= 0.0F) {
      return;
    }
    coverage.addInliers(1.0, static_cast<double>(error) / s);
  });
  return coverage;
}

void addCoverage(const SigmaCoverage& scene, double weight, SigmaCoverage& sum) {
  const double share = scene.pixels > 0.0 ? weight / scene.pixels : 0.0;
  sum.pixels += weight;
  sum.inliers += share * scene.inliers;
  sum.squared_sum += share * scene.squared_sum;
  for (std::size_t b = 0; b < SigmaCoverage::kBins; ++b) {
    sum.bins[b] += share * scene.bins[b];
  }
}

}  // namespace cbmv
