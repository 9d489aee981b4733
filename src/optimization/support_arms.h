#pragma once

#include <opencv2/core.hpp>

#include "cbmv_stereo/options.h"

namespace cbmv {

/// Support cross of every pixel (Zhang et al. 2009; Mei et al. 2011, section 2.2): the number of
/// pixels to the left, right, above and below with an intensity similar to the center.
///
/// An arm extends to the next pixel if
/// - the pixel is inside of the image,
/// - it is less than `max_length` pixels away, and
/// - it differs from the center by less than `threshold_gray` gray levels.
///
/// So an arm has at most max_length − 1 pixels in addition to the center.
///
/// `gray` is CV_8UC1. `arms` becomes CV_8UC4 of the same size with the channels left, right, up,
/// down, in pixels. Throws Error if `max_length` is not in [1, 255]. Parallel over rows by oneTBB.
void computeSupportArms(const cv::Mat& gray, int max_length, float threshold_gray, cv::Mat& arms);

}  // namespace cbmv
