#pragma once

#include <opencv2/core.hpp>

namespace cbmv {

/// Standard deviation of the intensities of an image in gray levels (population standard
/// deviation). It is the unit of the thresholds AggregationOptions::intensity_threshold and
/// SgmOptions::edge_threshold. `grey` is CV_8UC1 and not empty.
float greyDeviation(const cv::Mat& grey);

}  // namespace cbmv
