#pragma once

#include <opencv2/core.hpp>

namespace cbmv {

/// Floats of the longest vector that is used.
inline constexpr int kLongestVector = 16;

/// The disparities with a border of `radius` pixels, and so many pixels more on the right that a
/// whole vector can be read from any pixel of a window. Border and invalid pixels hold `filler`.
/// Reuses the memory of `padded`. Parallel over rows by oneTBB.
void padDisparity(const cv::Mat& disparity, float invalid, int radius, float filler,
                  cv::Mat& padded);

}  // namespace cbmv
