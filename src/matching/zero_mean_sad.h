#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

#include "matching/cost_row.h"
#include "matching/row_entries.h"

namespace cbmv {

/// Zero-mean sum of absolute differences in a 5 × 5 window (Batsos et al. 2018, section 3.1): Σ |(l
/// − mean l) − (r − mean r)|, in quarters of a gray level, in [0, 25 480]. Means are rounded to
/// quarters, so that the sum is exact in 16-bit integers.
class ZeroMeanSadMatcher {
 public:
  static constexpr int kWindowPx = 5;
  static constexpr int kUnitsPerGray = 4;

  /// Memory for one row at a time. One per thread.
  struct Scratch {
    std::vector<std::int16_t> differences;  ///< kWindowPx rows of the columns −2 … width + 1
    void resize(int width) {
      differences.resize(static_cast<std::size_t>(width + kWindowPx - 1) * kWindowPx);
    }
  };

  /// Prepares a pair. Both images are CV_8UC1, extended by padImage. Parallel over rows by oneTBB.
  void prepare(const cv::Mat& padded_left, const cv::Mat& padded_right);

  /// Computes the costs of the entries of row y.
  void computeRow(int y, const RowEntries& entries, Scratch& scratch,
                  CostRow<std::uint16_t>& costs) const;

  /// Data of the windows of one row, in quarters of a gray level; pointers to column 0.
  using Rows = std::array<const std::int16_t*, kWindowPx>;
  struct Windows {
    Rows rows;  ///< pixels
    const std::int16_t* means;
  };

 private:
  struct WindowStatistics {
    cv::Mat padded;  ///< CV_16SC1: the image
    cv::Mat means;   ///< CV_16SC1
    Windows row(int y) const;
  };
  static void prepareImage(const cv::Mat& padded, WindowStatistics& statistics);

  WindowStatistics left_;
  WindowStatistics right_;
};

}  // namespace cbmv
