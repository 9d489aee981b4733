#pragma once

#include <string>

#include <opencv2/core.hpp>

#include "io/calibration.h"

namespace cbmv {

/// A rectified pair with the true disparities of the left image, or without: `truth` and `visible`
/// are then empty. All other images have one size.
struct StereoScene {
  std::string name;
  cv::Mat left;        ///< CV_8UC1
  cv::Mat right;       ///< CV_8UC1
  cv::Mat left_color;  ///< CV_8UC3, BGR
  cv::Mat truth;       ///< CV_32FC1, px; NaN = unknown
  cv::Mat visible;     ///< CV_8UC1; 255 where the truth is known and both cameras see the point
  /// Width, height and disparities are always there: the disparities to search are
  /// 0 … disparities − 1, at most as many as there are columns. Where a data set has no
  /// calibration, the rest is 0.
  StereoCalibration calibration;
};

}  // namespace cbmv
