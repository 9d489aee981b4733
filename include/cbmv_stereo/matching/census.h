#pragma once

#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

#include "cbmv_stereo/matching/cost_row.h"

namespace cbmv {

/// Census cost in an 11 × 11 window (Zabih & Woodfill 1994; Batsos et al. 2018, section 3.1): the
/// number of the 120 neighbours that are darker than the centre in one image but not in the other.
class CensusMatcher {
 public:
  static constexpr int kWindowPx = 11;

  /// Prepares a pair. Both CV_8UC1, extended by padImage. Parallel over rows by oneTBB.
  void prepare(const cv::Mat& padded_left, const cv::Mat& padded_right);

  /// Costs of row y, in [0, 120].
  void computeRow(int y, const DisparityRange& range, CostRow& costs) const;

 private:
  /// One bit a neighbour, 60 a word.
  struct BitStrings {
    std::vector<std::uint64_t> upper;
    std::vector<std::uint64_t> lower;
  };
  static void transform(const cv::Mat& padded, BitStrings& bits);

  int width_ = 0;
  BitStrings left_;
  BitStrings right_;
};

}  // namespace cbmv
