#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

#include "matching/cost_row.h"
#include "matching/row_entries.h"

namespace cbmv {

/// Normalized cross-correlation in a 3 × 3 window (Batsos et al. 2018, section 3.1). The cost is
/// −NCC, in [−1, 1]; 1 if one of the windows has no texture.
class NccMatcher {
 public:
  static constexpr int kWindowPx = 3;

  /// Rows of the window; pointers to column 0.
  using Pixels = std::array<const std::uint8_t*, kWindowPx>;
  using Rows = std::array<const float*, kWindowPx>;

  /// Data of the windows of one row; pointers to column 0.
  struct Windows {
    Rows rows;                        ///< pixels
    const float* sums;                ///< sums of the pixels of each window
    const float* inverse_deviations;  ///< 1 / sqrt(9 Σ v² − (Σ v)²); 0 without texture
  };

  /// Memory for a row of one view.
  struct View {
    std::array<std::vector<float>, kWindowPx> rows;  ///< columns −1 … width
    std::vector<float> sums;
    std::vector<float> inverse_deviations;
    void resize(int width);
  };

  /// Memory for one row at a time. One per thread.
  struct Scratch {
    View left;
    View right;
    std::vector<float> column_sums;  ///< columns −1 … width
    void resize(int width);
  };

  /// Sets the pair. The images must not change while rows are computed. Both are CV_8UC1, extended
  /// by padImage.
  void prepare(const cv::Mat& padded_left, const cv::Mat& padded_right);

  /// Computes the costs of the entries of row y.
  void computeRow(int y, const RowEntries& entries, Scratch& scratch, CostRow<float>& costs) const;

 private:
  cv::Mat padded_left_;
  cv::Mat padded_right_;
};

}  // namespace cbmv
