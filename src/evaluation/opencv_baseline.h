#pragma once

#include <opencv2/calib3d.hpp>

#include "evaluation/disparity_source.h"

namespace cbmv {

/// How many disparities OpenCV's matchers search where `disparities` (at least 1) are wanted: the
/// next multiple of 16, as they demand.
int openCvDisparities(int disparities);

/// OpenCV's StereoSGBM as we compare with it: blocks of 5 × 5, P1 = 8 · 25 and P2 = 32 · 25, Sobel
/// cut off at 63, uniqueness 10 %, left-right difference of at most 1 px, speckles below 100 px
/// removed; over openCvDisparities(disparities) from 0 on.
cv::Ptr<cv::StereoSGBM> makeStereoSgbm(int disparities, int mode = cv::StereoSGBM::MODE_SGBM);

/// makeStereoSgbm in MODE_SGBM (5 paths), the method that stereo_image_proc users have today, to
/// stand beside ours in the same table; over the scene's own range. Holes, the columns at the left
/// among them, are filled along the row: by the lower of the nearest disparities at both sides,
/// which is the background's. Rows without any disparity stay without. No confidence.
DisparitySource stereoSgbmSource();

}  // namespace cbmv
