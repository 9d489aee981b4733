#pragma once

#include <opencv2/core.hpp>

namespace cbmv {

/// Width of the border that is added to images before matching, by repeating the border pixels.
/// With it, every pixel has a whole window for each matcher. The largest window is 11 × 11.
constexpr int kMatchingBorderPx = 5;

/// Extends `image` by kMatchingBorderPx on all sides. Reuses the memory of `padded`.
void padImage(const cv::Mat& image, cv::Mat& padded);

/// Pointer to pixel (0, y) of the image in `padded`. x and y may be up to kMatchingBorderPx outside
/// of the image.
template <typename Pixel>
const Pixel* paddedRow(const cv::Mat& padded, int y) {
  return padded.ptr<Pixel>(y + kMatchingBorderPx) + kMatchingBorderPx;
}

}  // namespace cbmv
