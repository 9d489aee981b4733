#pragma once

#include <string>

#include <opencv2/core.hpp>

#include "io/calibration.h"

namespace cbmv {

/// A rectified pair with the ground truth of the left image. Without ground truth, `truth` and
/// `visible` are empty. All other images have the same size.
struct StereoScene {
  std::string name;
  cv::Mat left;        ///< CV_8UC1
  cv::Mat right;       ///< CV_8UC1
  cv::Mat left_color;  ///< CV_8UC3, BGR
  cv::Mat truth;       ///< CV_32FC1, px; NaN = unknown
  cv::Mat visible;     ///< CV_8UC1; 255 where the truth is known and both cameras see the point
  /// Width, height and number of disparities are always set. The disparity range is 0 … disparities
  /// − 1, at most the number of columns. All other values are 0 if the data set has no calibration.
  StereoCalibration calibration;
};

}  // namespace cbmv
