#pragma once

#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "cbmv_stereo/io/calibration.h"

namespace cbmv {

/// A rectified pair with the true disparities of the left image. All images have one size.
struct StereoScene {
  std::string name;
  cv::Mat left;        ///< CV_8UC1
  cv::Mat right;       ///< CV_8UC1
  cv::Mat left_color;  ///< CV_8UC3, BGR
  cv::Mat truth;       ///< CV_32FC1, px; NaN = unknown
  cv::Mat visible;     ///< CV_8UC1; 255 where the truth is known and both cameras see the point
  StereoCalibration calibration;
};

/// Reads a folder in the layout of Middlebury v3: im0.png (left), im1.png (right), disp0GT.pfm,
/// mask0nocc.png and calib.txt. Where the mask is absent, `visible` is visibleInBoth(truth).
/// Throws Error naming the file that is missing or malformed, or both files and sizes when sizes
/// disagree.
StereoScene readMiddleburyScene(const std::string& folder);

/// Names of the subfolders of `folder` that hold im0.png and calib.txt, sorted.
/// Throws Error when `folder` is not a folder.
std::vector<std::string> listMiddleburyScenes(const std::string& folder);

}  // namespace cbmv
