#pragma once

#include <opencv2/core.hpp>

namespace cbmv {

/// Whether a pixel belongs to a thin object, such as a pole or a wire. Along the row, the column
/// and both diagonals, it counts the pixels whose disparity is within 1 px of that of the pixel,
/// among the pixel itself and 12 on each side. The object is thin if one direction has at least 8
/// of these 25, and another at most 4. Pixels beyond the image do not count. `disparity` is
/// CV_16SC1, in units of 1/8 px (MapPlanes).
bool isThin(const cv::Mat& disparity, int y, int x);

}  // namespace cbmv
