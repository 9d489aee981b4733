#pragma once

#include <opencv2/core.hpp>

namespace cbmv {

/// How well the standard deviations of disparities describe the errors of inliers, as sums that can
/// be added over scenes. An inlier is a pixel with an error up to the given limit and a standard
/// deviation above 0. Numbers are of pixels, or of parts of them after addCoverage.
struct SigmaCoverage {
  double pixels = 0.0;       ///< counted pixels
  double inliers = 0.0;      ///< of these; the following are over the inliers
  double within_1 = 0.0;     ///< |d − truth| at most one standard deviation
  double within_2 = 0.0;     ///< at most two
  double squared_sum = 0.0;  ///< sum of ((d − truth) / sigma)²

  double withinOne()
      const;  ///< percent of the inliers; 68.3 for normal errors; NaN without inliers
  double withinTwo() const;  ///< 95.4 for normal errors
  double rms() const;        ///< of error / sigma; 1 where sigma is right
};

/// Counts the pixels as evaluateDisparity does. `sigma` is CV_32FC1, px; not finite or at most 0 =
/// none. Throws Error when sizes or types differ.
SigmaCoverage coverSigma(const cv::Mat& disparity, const cv::Mat& sigma, const cv::Mat& truth,
                         const cv::Mat& mask, float invalid, float inlier_px);

/// Adds the coverage of a scene so that it has this weight, however many counted pixels it has.
void addCoverage(const SigmaCoverage& scene, double weight, SigmaCoverage& sum);

}  // namespace cbmv
