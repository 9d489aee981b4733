#pragma once

#include <cstdint>

#include <opencv2/core.hpp>

#include "cbmv_stereo/matching/census_transform.h"
#include "cbmv_stereo/matching/cost_row.h"

namespace cbmv {

/// Census cost in an 11 × 11 window (Zabih & Woodfill 1994; Batsos et al. 2018, section 3.1): the
/// number of the 120 neighbours that are darker than the centre in one image but not in the other.
class CensusMatcher {
 public:
  static constexpr int kWindowPx = 11;
  static constexpr int kBytes = (kWindowPx * kWindowPx - 1) / 8;  ///< one bit a neighbour

  /// Prepares a pair. Both CV_8UC1, extended by padImage. Parallel over rows by oneTBB.
  void prepare(const cv::Mat& padded_left, const cv::Mat& padded_right);

  /// Costs of row y, in [0, 120]; of `spans` alone where they are given.
  void computeRow(int y, const DisparityRange& range, CostRow<std::uint8_t>& costs,
                  const RowSpans* spans = nullptr) const;

 private:
  int width_ = 0;
  CensusTransform left_;
  CensusTransform right_;
};

}  // namespace cbmv
