#pragma once

#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

#include "cbmv_stereo/matching/cost_row.h"

namespace cbmv {

/// Zero-mean sum of absolute differences in a 5 × 5 window (Batsos et al. 2018, section 3.1):
/// Σ |(l − mean l) − (r − mean r)|, in grey levels, in [0, 6 370]. Means are rounded to a quarter
/// of a grey level, so that the sum is exact in 16-bit integers.
class ZeroMeanSadMatcher {
 public:
  static constexpr int kWindowPx = 5;

  /// Memory for one row at a time; one per thread.
  struct Scratch {
    std::vector<std::int16_t> differences;
  };

  /// Prepares a pair. Both CV_8UC1, extended by padImage; kept by reference count, not copied.
  void prepare(const cv::Mat& padded_left, const cv::Mat& padded_right);

  /// Costs of row y.
  void computeRow(int y, const DisparityRange& range, Scratch& scratch, CostRow& costs) const;

 private:
  cv::Mat padded_left_;
  cv::Mat padded_right_;
  cv::Mat left_means_;  ///< CV_16SC1, in quarters of a grey level
  cv::Mat right_means_;
};

}  // namespace cbmv
