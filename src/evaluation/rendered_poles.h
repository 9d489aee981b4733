#pragma once

#include <vector>

#include <opencv2/core.hpp>

namespace cbmv {

/// A synthetic rectified pair with thin poles in front of a distant background. Coarse-to-fine
/// search misses such objects first.
struct RenderedPoles {
  cv::Mat left;        ///< CV_8UC1
  cv::Mat right;       ///< CV_8UC1
  cv::Mat pole_width;  ///< CV_8UC1, left image: width of the pole in px, 0 = background
  int near_px;         ///< disparity of the poles
};

/// Widths of the poles, px.
const std::vector<int>& poleWidths();

/// Renders 640 × 480 pixels of noise texture at disparity `far_px`. Two vertical poles per width at
/// disparity `near_px` stand in front, one brighter and one darker than the background. Sensor
/// noise has a standard deviation of 2 gray levels, independent in both images. The same arguments
/// give the same pair. Both disparities are within 1 … 60; far_px is less than near_px.
RenderedPoles renderPoles(int far_px, int near_px, int seed);

/// Fraction of the pixels on poles of this width whose disparity (CV_32FC1) is within 1 px of the
/// truth.
double poleRecall(const RenderedPoles& poles, int width_px, const cv::Mat& disparity);

}  // namespace cbmv
