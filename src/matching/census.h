#pragma once

#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

#include "matching/census_transform.h"
#include "matching/cost_row.h"
#include "matching/row_entries.h"

namespace cbmv {

/// Census cost in an 11 × 11 window (Zabih & Woodfill 1994; Batsos et al. 2018, section 3.1): the
/// number of the 120 neighbors that are darker than the center in one image but not in the other.
class CensusMatcher {
 public:
  static constexpr int kWindowPx = 11;
  static constexpr int kBytes = (kWindowPx * kWindowPx - 1) / 8;  ///< one bit per neighbor

  /// Memory for one row at a time. One per thread.
  struct Scratch {
    std::vector<std::uint8_t> left;  ///< [byte][x]
    std::vector<std::uint8_t> right;
    void resize(int width);
  };

  /// Sets the pair. The images must not change while rows are computed. Both are CV_8UC1, extended
  /// by padImage.
  void prepare(const cv::Mat& padded_left, const cv::Mat& padded_right);

  /// Computes the costs of the entries of row y, in [0, 120].
  void computeRow(int y, const RowEntries& entries, Scratch& scratch,
                  CostRow<std::uint8_t>& costs) const;

 private:
  CensusTransform left_;
  CensusTransform right_;
};

}  // namespace cbmv
