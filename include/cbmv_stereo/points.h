#pragma once

#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

#include "cbmv_stereo/calibration_check.h"
#include "cbmv_stereo/export.h"

// Converts disparities to meters. "Valid disparities" are CV_32FC1 in px with Z = f T / d, NaN
// where there is no disparity. Node, bag tool and command line use these functions.

namespace cbmv {

struct ColoredPoint {
  float x, y, z;  ///< m
  std::uint8_t r, g, b;
};

/// Converts disparities of the matcher, which are `invalid` where there is none, to valid
/// disparities. Subtracts `disparity_offset_px` (StereoGeometry).
CBMV_API cv::Mat toValidDisparity(const cv::Mat& disparity, float invalid,
                                  double disparity_offset_px);

/// Depth Z in m along the optical axis of the left camera, CV_32FC1. NaN where there is no
/// disparity, and where the point is at or beyond infinity.
CBMV_API cv::Mat toDepth(const cv::Mat& valid_disparity, const StereoGeometry& geometry);

/// Standard deviation of Z in m, CV_32FC1: Z² / (f B) · disparity_sigma = f B disparity_sigma / d²,
/// with the valid disparity d and the baseline B. `disparity_sigma` is CV_32FC1 in px, of the same
/// size. NaN where toDepth gives NaN, and where `disparity_sigma` is not above 0. Valid for
/// inliers: see StereoResult::disparity_sigma.
CBMV_API cv::Mat toDepthSigma(const cv::Mat& valid_disparity, const cv::Mat& disparity_sigma,
                              const StereoGeometry& geometry);

/// The point of pixel (x, y) in the optical frame of the left camera, in m:
/// X = (x − cx) Z / fx, Y = (y − cy) Z / fy. NaN where `valid_disparity_px` is not above 0.
CBMV_API cv::Vec3f toPoint(const StereoGeometry& geometry, int x, int y, float valid_disparity_px);

/// The points that are not NaN, row by row. `color` is CV_8UC3 (blue, green, red) and has the size
/// of `valid_disparity`.
CBMV_API std::vector<ColoredPoint> toPoints(const cv::Mat& valid_disparity, const cv::Mat& color,
                                            const StereoGeometry& geometry);

}  // namespace cbmv
