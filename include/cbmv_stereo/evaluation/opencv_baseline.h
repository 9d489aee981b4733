#pragma once

#include "cbmv_stereo/evaluation/disparity_source.h"

namespace cbmv {

/// OpenCV's StereoSGBM, the method that stereo_image_proc users have today, to stand beside ours in
/// the same table. MODE_SGBM (5 paths), blocks of 5 × 5, P1 = 8 · 25 and P2 = 32 · 25, Sobel cut
/// off at 63, uniqueness 10 %, left-right difference of at most 1 px, speckles below 100 px
/// removed; over the scene's own range, rounded up to whole sixteens as StereoSGBM demands. Holes,
/// the columns at the left among them, are filled along the row: by the lower of the nearest
/// disparities at both sides, which is the background's. Rows without any disparity stay without.
/// No confidence.
DisparitySource stereoSgbmSource();

}  // namespace cbmv
