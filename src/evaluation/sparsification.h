#pragma once

#include <vector>

#include <opencv2/core.hpp>

namespace cbmv {

/// How well a confidence map separates right from wrong disparities (Hu and Mordohai 2012, section
/// 5).
struct Sparsification {
  /// bad[k]: percent of bad pixels (|d − truth| > bad_px or no d) among the k + 1 percent most
  /// confident counted pixels, k = 0 … 99. bad[99] covers all counted pixels.
  std::vector<double> bad;
  std::vector<double> bad_optimal;  ///< the same if all good pixels came before all bad ones
  double auc = 0.0;                 ///< area under the curve: the mean of bad, percent
  double auc_optimal = 0.0;         ///< area under bad_optimal, percent
};

/// Counts the same pixels as evaluateDisparity. `confidence` is CV_32FC1, higher is better; NaN
/// comes last, as do pixels without a disparity. Pixels with equal confidence all count with their
/// mean fraction of bad pixels, so their order does not matter. Fractions of pixels are counted.
/// All zero when no pixel is counted. Throws Error when sizes or types differ.
Sparsification sparsify(const cv::Mat& disparity, const cv::Mat& confidence, const cv::Mat& truth,
                        const cv::Mat& mask, float invalid, float bad_px);

}  // namespace cbmv
