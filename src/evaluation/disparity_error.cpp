#include "evaluation/disparity_error.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include "evaluation/map_checks.h"

namespace cbmv {
namespace {

constexpr float kOutlierPx = 3.0F;
constexpr float kOutlierShare = 0.05F;   // fraction of the truth
constexpr double kRankTolerance = 1e-9;  // rounds 0.9 · 10 to 9

double percent(long part, long whole) {
  return whole == 0 ? 0.0 : 100.0 * static_cast<double>(part) / static_cast<double>(whole);
}

/// Smallest value that is not exceeded by the fraction `share` of the values. Reorders them.
double quantile(std::vector<float>& values, double share) {
  const auto rank = static_cast<std::ptrdiff_t>(
      std::ceil(share * static_cast<double>(values.size()) - kRankTolerance));
  const auto position = values.begin() + std::max<std::ptrdiff_t>(rank, 1) - 1;
  std::nth_element(values.begin(), position, values.end());
  return *position;
}

/// Index in DisparityError::histogram.
std::size_t binOf(float error) {
  const double end = std::ceil(static_cast<double>(error) / kErrorBinPx);
  return end > kErrorBins ? kErrorBins : static_cast<std::size_t>(std::max(end, 1.0)) - 1;
}

/// Sums over the counted pixels.
struct ErrorSums {
  static constexpr std::array<float, 5> kThresholds = {0.5F, 1.0F, 2.0F, 3.0F, 4.0F};  // px
  std::array<long, 5> bad = {};
  std::array<long, kErrorBins + 1> bins = {};
  long outliers = 0;
  long pixels = 0;
  std::vector<float> errors;  ///< px, pixels with a disparity only
  double absolute = 0.0;
  double squared = 0.0;

  void add(float disparity, float truth, float invalid) {
    const bool valid = hasDisparity(disparity, invalid);
    const float error = std::abs(disparity - truth);
    for (std::size_t t = 0; t < bad.size(); ++t) {
      bad[t] += !valid || error > kThresholds[t] ? 1 : 0;
    }
    const bool outlier = error > kOutlierPx && error > kOutlierShare * std::abs(truth);
    outliers += !valid || outlier ? 1 : 0;
    ++bins[valid ? binOf(error) : kErrorBins];
    ++pixels;
    if (valid) {
      errors.push_back(error);
      absolute += error;
      squared += static_cast<double>(error) * error;
    }
  }

  long dense() const { return static_cast<long>(errors.size()); }
};

}  // namespace

DisparityError evaluateDisparity(const cv::Mat& disparity, const cv::Mat& truth,
                                 const cv::Mat& mask, float invalid) {
  requireMap(disparity, "disparity", CV_32FC1, disparity.size());
  requireMap(truth, "truth", CV_32FC1, disparity.size());
  requireMap(mask, "mask", CV_8UC1, disparity.size());
  ErrorSums sums;
  forCountedPixels(truth, mask, [&](int y, int x) {
    sums.add(disparity.at<float>(y, x), truth.at<float>(y, x), invalid);
  });
  DisparityError error;
  error.bad_05 = percent(sums.bad[0], sums.pixels);
  error.bad_1 = percent(sums.bad[1], sums.pixels);
  error.bad_2 = percent(sums.bad[2], sums.pixels);
  error.bad_3 = percent(sums.bad[3], sums.pixels);
  error.bad_4 = percent(sums.bad[4], sums.pixels);
  error.d1 = percent(sums.outliers, sums.pixels);
  for (std::size_t k = 0; k <= kErrorBins; ++k) {
    error.histogram[k] = percent(sums.bins[k], sums.pixels);
  }
  error.density = percent(sums.dense(), sums.pixels);
  error.pixels = sums.pixels;
  if (sums.dense() > 0) {
    error.average_px = sums.absolute / static_cast<double>(sums.dense());
    error.rms_px = std::sqrt(sums.squared / static_cast<double>(sums.dense()));
    error.a50_px = quantile(sums.errors, 0.5);
    error.a90_px = quantile(sums.errors, 0.9);
    error.a99_px = quantile(sums.errors, 0.99);
  }
  return error;
}

}  // namespace cbmv
