#pragma once

#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

#include "cbmv_stereo/calibration_check.h"
#include "cbmv_stereo/export.h"

// From disparities to metres. "Valid disparities" are CV_32FC1, px, such that Z = f T / d, and NaN
// where there is none. Node, bag tool and command line compute with these functions.

namespace cbmv {

struct ColoredPoint {
  float x, y, z;  ///< m
  std::uint8_t r, g, b;
};

/// Valid disparities from those of the matcher, which are `invalid` where there is none: takes
/// `disparity_offset_px` (StereoGeometry) off.
CBMV_API cv::Mat toValidDisparity(const cv::Mat& disparity, float invalid,
                                  double disparity_offset_px);

/// Z in m along the left camera's optical axis, CV_32FC1, of valid disparities: NaN where there is
/// none, or the point lies at or beyond infinity.
CBMV_API cv::Mat toDepth(const cv::Mat& valid_disparity, const StereoGeometry& geometry);

/// Standard deviation of Z in m, CV_32FC1, of valid disparities d whose standard deviation is
/// `disparity_sigma` (CV_32FC1, px, of the same size): Z² / (f B) times it, which is
/// f B disparity_sigma / d². NaN where toDepth gives NaN, and where `disparity_sigma` is not above
/// 0. Holds for inliers: see StereoResult::disparity_sigma.
CBMV_API cv::Mat toDepthSigma(const cv::Mat& valid_disparity, const cv::Mat& disparity_sigma,
                              const StereoGeometry& geometry);

/// The point of pixel (x, y) in the left camera's optical frame, m:
/// X = (x − cx) Z / fx, Y = (y − cy) Z / fy. NaN where `valid_disparity_px` is not above 0.
CBMV_API cv::Vec3f toPoint(const StereoGeometry& geometry, int x, int y, float valid_disparity_px);

/// The points that are not NaN, row by row. `color` is CV_8UC3 (blue, green, red) of the size of
/// `valid_disparity`.
CBMV_API std::vector<ColoredPoint> toPoints(const cv::Mat& valid_disparity, const cv::Mat& color,
                                            const StereoGeometry& geometry);

}  // namespace cbmv
