#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

#include "cbmv_stereo/matching/cost_row.h"
#include "cbmv_stereo/matching/row_entries.h"

namespace cbmv {

/// Census cost in an 11 × 11 window (Zabih & Woodfill 1994; Batsos et al. 2018, section 3.1): the
/// number of the 120 neighbours that are darker than the centre in one image but not in the other.
class CensusMatcher {
 public:
  static constexpr int kWindowPx = 11;
  static constexpr int kBytes = (kWindowPx * kWindowPx - 1) / 8;  ///< one bit a neighbour

  /// Prepares a pair. Both CV_8UC1, extended by padImage. Parallel over rows by oneTBB.
  void prepare(const cv::Mat& padded_left, const cv::Mat& padded_right);

  /// Costs of the entries of row y, in [0, 120].
  void computeRow(int y, const RowEntries& entries, CostRow<std::uint8_t>& costs) const;

 private:
  std::size_t rowOffset(int y) const { return static_cast<std::size_t>(y) * kBytes * width_; }
  void transform(const cv::Mat& padded, std::vector<std::uint8_t>& bits) const;

  int width_ = 0;
  std::vector<std::uint8_t> left_;  ///< [y][byte][x]
  std::vector<std::uint8_t> right_;
};

}  // namespace cbmv
