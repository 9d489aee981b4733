#pragma once

#include <vector>

#include <opencv2/core.hpp>

namespace cbmv {

/// A synthetic rectified pair of thin poles before a far background: what coarse-to-fine search
/// loses first.
struct RenderedPoles {
  cv::Mat left;        ///< CV_8UC1
  cv::Mat right;       ///< CV_8UC1
  cv::Mat pole_width;  ///< CV_8UC1, of the left image: width of the pole in px, 0 = background
  int near_px;         ///< disparity of the poles
};

/// Widths of the poles, px.
const std::vector<int>& poleWidths();

/// Renders 640 × 480 pixels of noise texture at the disparity `far_px`, and two upright poles of
/// each width at the disparity `near_px`, one brighter and one darker than the background. Sensor
/// noise has 2 gray levels, independent in both images. The same arguments give the same pair.
/// Both disparities are within 1 … 60, far_px is below near_px.
RenderedPoles renderPoles(int far_px, int near_px, int seed);

/// Share of the pixels of all poles of that width whose disparity (CV_32FC1) is within 1 px of the
/// truth.
double poleRecall(const RenderedPoles& poles, int width_px, const cv::Mat& disparity);

}  // namespace cbmv
