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

  /// Sums around row `y` of `plane`, which is CV_8UC1, CV_16UC1 or CV_16SC1 with values up to ±
  /// 2^15. Returns one sum per column, valid until the next call.
  const std::int32_t* sums(const cv::Mat& plane, int y);

 private:
  std::vector<std::int32_t> vertical_;  ///< with kRadius more columns on both sides
  std::vector<std::int32_t> sums_;
};

}  // namespace cbmv
