#pragma once

#include <array>
#include <cstddef>

#include <opencv2/core.hpp>

namespace cbmv {

/// Share of the absolute errors of a normal distribution that are within one standard deviation.
inline constexpr double kOneSigmaShare = 0.6827;

/// Compares the standard deviations of disparities with the errors of inliers, as sums that can be
/// added over scenes. An inlier is a pixel with an error up to the given limit and a standard
/// deviation above 0. Counts are pixels, or fractions of pixels after addCoverage. The ratio of an
/// inlier is |d − truth| / sigma.
struct SigmaCoverage {
  static constexpr std::size_t kBinsPerSigma = 16;
  static constexpr std::size_t kBins = 16 * kBinsPerSigma;

  double pixels = 0.0;       ///< counted pixels
  double inliers = 0.0;      ///< inliers among the counted pixels
  double squared_sum = 0.0;  ///< sum of the squared ratios of the inliers
  /// Inliers by ratio. Bin b ends at, and includes, (b + 1) / kBinsPerSigma; the last has no end.
  std::array<double, kBins> bins{};

  void addInliers(double count, double ratio);
  /// The ratio that this share of the inliers does not exceed, within the accuracy of the bins.
  /// NaN without inliers.
  double ratioQuantile(double share) const;
  /// Inliers with a ratio of at most 1, percent of all; 68.3 for normal errors; NaN without
  /// inliers.
  double withinOne() const;
  double withinTwo() const;  ///< the same with a ratio of at most 2; 95.4 for normal errors
  double rms() const;        ///< RMS of the ratios; 1 for normal errors
};

/// Counts the same pixels as evaluateDisparity. `sigma` is CV_32FC1, px; not finite or at most 0 =
/// none. Throws Error when sizes or types differ.
SigmaCoverage coverSigma(const cv::Mat& disparity, const cv::Mat& sigma, const cv::Mat& truth,
                         const cv::Mat& mask, float invalid, float inlier_px);

/// Adds the coverage of a scene, scaled to the given weight independent of its number of pixels.
void addCoverage(const SigmaCoverage& scene, double weight, SigmaCoverage& sum);

}  // namespace cbmv
