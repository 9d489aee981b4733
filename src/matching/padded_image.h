#pragma once

#include <opencv2/core.hpp>

namespace cbmv {

/// Pixels by which images are extended before matching, by repeating the border, so that every
/// pixel has a whole window for each matcher. The largest window is 11 × 11.
constexpr int kMatchingBorderPx = 5;

/// `image` extended by kMatchingBorderPx on all sides. Reuses the memory of `padded`.
void padImage(const cv::Mat& image, cv::Mat& padded);

/// Pointer to pixel (0, y) of the image inside of `padded`; x and y may reach
/// kMatchingBorderPx outside of it.
template <typename Pixel>
const Pixel* paddedRow(const cv::Mat& padded, int y) {
  return padded.ptr<Pixel>(y + kMatchingBorderPx) + kMatchingBorderPx;
}

}  // namespace cbmv
