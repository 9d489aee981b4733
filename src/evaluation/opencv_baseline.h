#pragma once

#include <opencv2/calib3d.hpp>

#include "evaluation/disparity_source.h"

namespace cbmv {

/// Number of disparities that OpenCV's matchers search if `disparities` (at least 1) are requested:
/// rounded up to a multiple of 16, which OpenCV requires.
int openCvDisparities(int disparities);

/// OpenCV's StereoSGBM as used for comparison: block size 5, P1 = 8 · 25, P2 = 32 · 25,
/// preFilterCap 63, uniquenessRatio 10 %, disp12MaxDiff 1 px, speckles below 100 px removed. The
/// range is openCvDisparities(disparities), starting at 0.
cv::Ptr<cv::StereoSGBM> makeStereoSgbm(int disparities, int mode = cv::StereoSGBM::MODE_SGBM);

/// Runs makeStereoSgbm in MODE_SGBM (5 paths), the method of stereo_image_proc, over the scene's
/// disparity range. Holes, including the columns at the left border, are filled along the row with
/// the smaller of the nearest disparities on both sides, which belongs to the background. Rows
/// without any disparity stay empty. Returns no confidence.
DisparitySource stereoSgbmSource();

}  // namespace cbmv
