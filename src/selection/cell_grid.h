#pragma once

#include <cstdint>

#include <opencv2/core.hpp>

namespace cbmv {

/// Sums of a map over cells of 4 × 4 pixels, and from them means over large square windows, which
/// so cost little per pixel. Cells that reach beyond the image repeat its last column and row.
class CellGrid {
 public:
  static constexpr int kCellPx = 4;
  static constexpr int kMostCells = 31;  ///< side length of the largest window

  /// Sums up `map`: CV_8UC1, CV_16UC1 or CV_16SC1. Parallel over rows of cells by oneTBB.
  void sum(const cv::Mat& map);

  /// `means` (CV_32SC1, one value per cell) becomes the mean over the pixels of a window of
  /// `cells` × `cells` cells (odd, at most kMostCells) around each cell, rounded down. Windows that
  /// reach beyond the grid repeat its last cells. Parallel over rows of cells.
  void windowMeans(int cells, cv::Mat& means);

  /// What `means` has for the cell of pixel (x, y); those of the cells on its right lie behind.
  static const std::int32_t* at(const cv::Mat& means, int y, int x) {
    return means.ptr<std::int32_t>(y / kCellPx, x / kCellPx);
  }

  int rows() const { return sums_.rows; }
  int columns() const { return sums_.cols; }

 private:
  cv::Mat sums_;           ///< CV_32SC1
  cv::Mat vertical_sums_;  ///< over the rows of a window
};

}  // namespace cbmv
