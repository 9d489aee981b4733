#pragma once

#include <cstdint>

#include <opencv2/core.hpp>

namespace cbmv {

/// Sums a map over cells of 4 × 4 pixels and computes means over large square windows from them, at
/// low cost per pixel. Cells that reach beyond the image repeat its last column and row.
class CellGrid {
 public:
  static constexpr int kCellPx = 4;
  static constexpr int kMostCells = 31;  ///< largest window size in cells

  /// Sums `map`: CV_8UC1, CV_16UC1 or CV_16SC1. Parallel over rows of cells by oneTBB.
  void sum(const cv::Mat& map);

  /// Sets `means` (CV_32SC1, one value per cell) to the mean over the pixels of a window of `cells`
  /// × `cells` cells around each cell, rounded down. `cells` is odd and at most kMostCells. Windows
  /// that reach beyond the grid repeat its last cells. Parallel over rows of cells by oneTBB.
  void windowMeans(int cells, cv::Mat& means);

  /// The value of `means` for the cell of pixel (x, y). The values of the cells to its right follow
  /// it.
  static const std::int32_t* at(const cv::Mat& means, int y, int x) {
    return means.ptr<std::int32_t>(y / kCellPx, x / kCellPx);
  }

  int rows() const { return sums_.rows; }
  int columns() const { return sums_.cols; }

 private:
  cv::Mat sums_;           ///< CV_32SC1
  cv::Mat vertical_sums_;  ///< sums over the rows of a window
};

}  // namespace cbmv
