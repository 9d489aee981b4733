#pragma once

#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

namespace cbmv {

/// Sums over windows of 5 × 5 pixels around the pixels of a row. Windows that reach beyond the
/// image repeat its last columns and rows.
class WindowRow {
 public:
  static constexpr int kRadius = 2;
  static constexpr int kPixels = (2 * kRadius + 1) * (2 * kRadius + 1);

  void resize(int width);

  /// Of row `y` of `plane`: CV_8UC1, CV_16UC1 or CV_16SC1 with values up to ± 2^15. The result
  /// holds a sum per column and is valid until the next call.
  const std::int32_t* sums(const cv::Mat& plane, int y);

 private:
  std::vector<std::int32_t> vertical_;  ///< with kRadius columns more on both sides
  std::vector<std::int32_t> sums_;
};

}  // namespace cbmv
