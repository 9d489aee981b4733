#pragma once

#include <opencv2/core.hpp>

namespace cbmv {

/// Does a pixel belong to something thin, such as a pole or a wire? Looks at the 12 pixels on both
/// sides along the row, the column and both diagonals: within 1 px of the disparity of the pixel
/// are at least 8 of the 25 in one direction, and at most 4 in another. Pixels beyond the image do
/// not count. `disparity` is CV_16SC1, in units of 1/8 px (MapPlanes).
bool isThin(const cv::Mat& disparity, int y, int x);

}  // namespace cbmv
