#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

namespace cbmv {

/// Census transform of an image: which neighbours of a pixel, in a window around it, are darker
/// than the pixel itself (Zabih & Woodfill 1994). One bit a neighbour in raster order, eight to a
/// byte, laid out [y][byte][x]; bits behind the last neighbour are 0.
class CensusTransform {
 public:
  /// `padded` is CV_8UC1, extended by padImage; the sides of `window` are odd, at most
  /// 2 · kMatchingBorderPx + 1. Parallel over rows by oneTBB.
  void compute(const cv::Mat& padded, cv::Size window);

  /// Of a pixel.
  int bytes() const { return bytes_; }
  /// Byte k of the pixels of a row, from column 0 on.
  const std::uint8_t* row(int y, int k = 0) const {
    return bits_.data() + (static_cast<std::size_t>(y) * bytes_ + k) * width_;
  }

 private:
  int width_ = 0;
  int bytes_ = 0;
  std::vector<std::uint8_t> bits_;
  std::vector<std::ptrdiff_t> neighbour_distances_;  ///< in memory, in raster order
};

}  // namespace cbmv
