#include "evaluation/sigma_coverage.h"

#include <cmath>
#include <limits>

#include "evaluation/map_checks.h"

namespace cbmv {
namespace {

double ratio(double part, double whole) {
  return whole > 0.0 ? part / whole : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace

double SigmaCoverage::withinOne() const { return 100.0 * ratio(within_1, inliers); }

double SigmaCoverage::withinTwo() const { return 100.0 * ratio(within_2, inliers); }

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
    const double ratio = static_cast<double>(error) / s;
    coverage.inliers += 1.0;
    coverage.within_1 += ratio <= 1.0 ? 1.0 : 0.0;
    coverage.within_2 += ratio <= 2.0 ? 1.0 : 0.0;
    coverage.squared_sum += ratio * ratio;
  });
  return coverage;
}

void addCoverage(const SigmaCoverage& scene, double weight, SigmaCoverage& sum) {
  const double share = scene.pixels > 0.0 ? weight / scene.pixels : 0.0;
  sum.pixels += weight;
  sum.inliers += share * scene.inliers;
  sum.within_1 += share * scene.within_1;
  sum.within_2 += share * scene.within_2;
  sum.squared_sum += share * scene.squared_sum;
}

}  // namespace cbmv
