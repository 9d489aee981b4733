#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include "cbmv_stereo/matching/cost_row.h"

namespace cbmv {

/// Normalised cross-correlation in a 3 × 3 window (Batsos et al. 2018, section 3.1): the cost is
/// −NCC, in [−1, 1]; 1 where one of the windows has no texture at all.
class NccMatcher {
 public:
  static constexpr int kWindowPx = 3;

  /// Prepares a pair. Both CV_8UC1, extended by padImage; kept by reference count, not copied.
  void prepare(const cv::Mat& padded_left, const cv::Mat& padded_right);

  /// Costs of row y.
  void computeRow(int y, const DisparityRange& range, CostRow& costs) const;

 private:
  struct WindowStatistics {
    cv::Mat padded;
    cv::Mat sums;                ///< CV_32SC1: sum of the window
    cv::Mat inverse_deviations;  ///< CV_32FC1: 1 / sqrt(9 Σ v² − (Σ v)²); 0 without texture
  };
  static void prepareImage(const cv::Mat& padded, WindowStatistics& statistics);

  WindowStatistics left_;
  WindowStatistics right_;
};

}  // namespace cbmv
