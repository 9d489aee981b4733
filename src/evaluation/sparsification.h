#pragma once

#include <vector>

#include <opencv2/core.hpp>

namespace cbmv {

/// How well a confidence map tells right from wrong disparities (Hu and Mordohai 2012, section 5).
struct Sparsification {
  /// bad[k]: percent of bad pixels (|d − truth| > bad_px or no d) among the k + 1 percent of the
  /// counted pixels that are most confident, k = 0 … 99; bad[99] is that of all pixels.
  std::vector<double> bad;
  std::vector<double> bad_optimal;  ///< the same if all good pixels came before all bad ones
  double auc = 0.0;                 ///< area under that curve: the mean of bad, percent
  double auc_optimal = 0.0;         ///< area under bad_optimal, percent
};

/// Counts the pixels as evaluateDisparity does. `confidence` is CV_32FC1, higher is better; NaN
/// comes last, and so does a pixel without a disparity. Pixels of equal confidence are taken as a
/// mixture with the share of bad pixels that all of them have, so that their order does not matter;
/// fractions of pixels count as such. All zero when no pixel is counted. Throws Error when sizes or
/// types differ.
Sparsification sparsify(const cv::Mat& disparity, const cv::Mat& confidence, const cv::Mat& truth,
                        const cv::Mat& mask, float invalid, float bad_px);

}  // namespace cbmv
