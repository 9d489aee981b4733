#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

#include "matching/cost_row.h"
#include "matching/row_entries.h"

namespace cbmv {

/// Sum of absolute differences of horizontal Sobel responses in a 5 × 5 window (Batsos et al. 2018,
/// section 3.1). The Sobel kernel is (−1 0 1; −2 0 2; −1 0 1), not scaled. Costs are in [0, 51
/// 000].
class SobelSadMatcher {
 public:
  static constexpr int kWindowPx = 5;

  /// Memory for one row at a time. One per thread.
  struct Scratch {
    std::vector<std::uint16_t> column_sums;  ///< columns −2 … width + 1
    void resize(int width) { column_sums.resize(static_cast<std::size_t>(width) + kWindowPx - 1); }
  };

  /// Prepares a pair. Both images are CV_8UC1, extended by padImage. Parallel over rows by oneTBB.
  void prepare(const cv::Mat& padded_left, const cv::Mat& padded_right);

  /// Computes the costs of the entries of row y.
  void computeRow(int y, const RowEntries& entries, Scratch& scratch,
                  CostRow<std::uint16_t>& costs) const;

  /// Responses in the window rows of one image row; pointers to column 0.
  using Rows = std::array<const std::int16_t*, kWindowPx>;

 private:
  cv::Mat left_responses_;  ///< CV_16SC1, padded; set where windows reach
  cv::Mat right_responses_;
};

}  // namespace cbmv
