#pragma once

#include <opencv2/core.hpp>

namespace cbmv {

/// Compares the standard deviations of disparities with the errors of inliers, as sums that can be
/// added over scenes. An inlier is a pixel with an error up to the given limit and a standard
/// deviation above 0. Counts are pixels, or fractions of pixels after addCoverage.
struct SigmaCoverage {
  double pixels = 0.0;       ///< counted pixels
  double inliers = 0.0;      ///< inliers among the counted pixels
  double within_1 = 0.0;     ///< inliers with |d − truth| of at most one standard deviation
  double within_2 = 0.0;     ///< the same with two standard deviations
  double squared_sum = 0.0;  ///< sum of ((d − truth) / sigma)² over the inliers

  double withinOne()
      const;  ///< percent of the inliers; 68.3 for normal errors; NaN without inliers
  double withinTwo() const;  ///< 95.4 for normal errors
  double rms() const;        ///< RMS of error / sigma; 1 if sigma is correct
};

/// Counts the same pixels as evaluateDisparity. `sigma` is CV_32FC1, px; not finite or at most 0 =
/// none. Throws Error when sizes or types differ.
SigmaCoverage coverSigma(const cv::Mat& disparity, const cv::Mat& sigma, const cv::Mat& truth,
                         const cv::Mat& mask, float invalid, float inlier_px);

/// Adds the coverage of a scene, scaled to the given weight independent of its number of pixels.
void addCoverage(const SigmaCoverage& scene, double weight, SigmaCoverage& sum);

}  // namespace cbmv
