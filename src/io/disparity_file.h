#pragma once

#include <string>

#include <opencv2/core.hpp>

namespace cbmv {

/// Reads disparities as CV_32FC1, px, NaN = unknown: from a portable float map (extension .pfm
/// in upper or lower case)
/// value / divisor, where values that are not finite are unknown; from any other image, which must
/// be grey with 8 or 16 bits, value / divisor, where 0 is unknown.
/// Throws Error naming the file when it is missing, malformed or of another type.
cv::Mat readDisparity(const std::string& path, double divisor);

/// Disparities (CV_32FC1, px; not finite = none) as the CV_16UC1 image that KITTI takes: 256 times
/// px, rounded; 0 = none, so that no disparity becomes 0.
cv::Mat toKittiDisparity(const cv::Mat& disparity);

}  // namespace cbmv
