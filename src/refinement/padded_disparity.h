#pragma once

#include <opencv2/core.hpp>

namespace cbmv {

/// Number of floats of the longest vector.
inline constexpr int kLongestVector = 16;

/// Copies the disparities and adds a border of `radius` pixels, plus pixels on the right so that a
/// whole vector can be read from any pixel of a window. The border and invalid pixels get `filler`.
/// Reuses the memory of `padded`. Parallel over rows by oneTBB.
void padDisparity(const cv::Mat& disparity, float invalid, int radius, float filler,
                  cv::Mat& padded);

}  // namespace cbmv
