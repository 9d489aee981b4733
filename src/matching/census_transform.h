#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

namespace cbmv {

/// Census transform of an image, row by row (Zabih & Woodfill 1994): which neighbors in a window
/// around a pixel are darker than the pixel. One bit per neighbor in raster order, eight bits per
/// byte. Bits after the last neighbor are 0.
class CensusTransform {
 public:
  /// Sets the image, which must not change while rows are computed. `padded` is CV_8UC1, extended
  /// by padImage. The sides of `window` are odd and at most 2 · kMatchingBorderPx + 1.
  void prepare(const cv::Mat& padded, cv::Size window);

  /// Bytes per pixel.
  int bytes() const { return (static_cast<int>(neighbor_distances_.size()) + 7) / 8; }
  int width() const { return width_; }

  /// Computes row y: byte k of column x is bits[k · width() + x].
  void computeRow(int y, std::uint8_t* bits) const;

 private:
  cv::Mat padded_;
  int width_ = 0;
  std::vector<std::ptrdiff_t> neighbor_distances_;  ///< in memory, in raster order
};

}  // namespace cbmv
