#pragma once

#include <opencv2/core.hpp>

namespace cbmv {

/// Standard deviation of an image's intensity, in grey levels: the unit of the thresholds
/// AggregationOptions::intensity_threshold and SgmOptions::edge_threshold. Of all pixels, so
/// divided by their number. `grey` is CV_8UC1 and not empty.
float greyDeviation(const cv::Mat& grey);

}  // namespace cbmv
