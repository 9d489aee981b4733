#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include "cbmv_stereo/io/calibration.h"
#include "cbmv_stereo/io/ply.h"

namespace cbmv {

/// Z = f B / (d + doffs) in metres, CV_32FC1, of disparities (CV_32FC1, px): NaN where these are
/// `invalid`, and where the point would lie at infinity or behind it.
cv::Mat toDepth(const cv::Mat& disparity, float invalid, const StereoCalibration& calibration);

/// The points with a depth, in the left camera's frame: X = (x − cx) Z / f, Y = (y − cy) Z / f.
/// `color` is CV_8UC3, blue, green, red, of the size of `depth`.
std::vector<ColoredPoint> toPoints(const cv::Mat& depth, const cv::Mat& color,
                                   const StereoCalibration& calibration);

}  // namespace cbmv
