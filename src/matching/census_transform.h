#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

namespace cbmv {

/// Census transform of an image, row by row: which neighbours of a pixel, in a window around it, are
/// darker than the pixel itself (Zabih & Woodfill 1994). One bit a neighbour in raster order, eight
/// to a byte; bits behind the last neighbour are 0.
class CensusTransform {
 public:
  /// Takes an image, which has to stay as it is while rows are computed. `padded` is CV_8UC1,
  /// extended by padImage; the sides of `window` are odd, at most 2 · kMatchingBorderPx + 1.
  void prepare(const cv::Mat& padded, cv::Size window);

  /// Of a pixel.
  int bytes() const { return (static_cast<int>(neighbour_distances_.size()) + 7) / 8; }
  int width() const { return width_; }

  /// Byte k of column x of row y becomes bits[k · width() + x].
  void computeRow(int y, std::uint8_t* bits) const;

 private:
  cv::Mat padded_;
  int width_ = 0;
  std::vector<std::ptrdiff_t> neighbour_distances_;  ///< in memory, in raster order
};

}  // namespace cbmv
