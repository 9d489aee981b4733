#pragma once

#include <opencv2/core.hpp>

#include "cbmv_stereo/options.h"

namespace cbmv {

/// Support cross of every pixel (Zhang et al. 2009; Mei et al. 2011, section 2.2): how far it
/// reaches left, right, up and down before the intensity departs from the centre's.
///
/// An arm takes in the next pixel while it lies inside the image, is fewer than `max_length` pixels
/// away and differs from the centre by less than `threshold_grey` grey levels, so an arm holds at
/// most max_length − 1 pixels beside the centre.
///
/// `grey` is CV_8UC1. `arms` becomes CV_8UC4 of the same size: channels left, right, up, down, in
/// pixels. Throws Error unless `max_length` is in [1, 255]. Parallel over rows by oneTBB.
void computeSupportArms(const cv::Mat& grey, int max_length, float threshold_grey, cv::Mat& arms);

}  // namespace cbmv
