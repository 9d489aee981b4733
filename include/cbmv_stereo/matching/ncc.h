#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include <opencv2/core.hpp>

#include "cbmv_stereo/matching/cost_row.h"
#include "cbmv_stereo/matching/row_entries.h"

namespace cbmv {

/// Normalised cross-correlation in a 3 × 3 window (Batsos et al. 2018, section 3.1): the cost is
/// −NCC, in [−1, 1]; 1 where one of the windows has no texture at all.
class NccMatcher {
 public:
  static constexpr int kWindowPx = 3;

  /// Memory for one row at a time; one per thread.
  struct Scratch {
    std::vector<float> column_sums;  ///< of the columns −1 … width
    void resize(int width) { column_sums.resize(static_cast<std::size_t>(width) + 2); }
  };

  /// Prepares a pair. Both CV_8UC1, extended by padImage. Parallel over rows by oneTBB.
  void prepare(const cv::Mat& padded_left, const cv::Mat& padded_right);

  /// Costs of the entries of row y.
  void computeRow(int y, const RowEntries& entries, Scratch& scratch, CostRow<float>& costs) const;

  /// What is known of the windows of one row; pointers to column 0.
  using Rows = std::array<const float*, kWindowPx>;
  struct Windows {
    Rows rows;  ///< the pixels
    const float* sums;
    const float* inverse_deviations;
  };

 private:
  struct WindowStatistics {
    cv::Mat padded;              ///< CV_32FC1: the image
    cv::Mat sums;                ///< CV_32FC1: sum of the window
    cv::Mat inverse_deviations;  ///< CV_32FC1: 1 / sqrt(9 Σ v² − (Σ v)²); 0 without texture
    Windows row(int y) const;
  };
  static void prepareImage(const cv::Mat& padded, WindowStatistics& statistics);

  WindowStatistics left_;
  WindowStatistics right_;
};

}  // namespace cbmv
