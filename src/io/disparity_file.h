#pragma once

#include <string>

#include <opencv2/core.hpp>

namespace cbmv {

/// Reads disparities as CV_32FC1 in px, NaN = unknown. Values are divided by `divisor`.
/// - Portable float map (extension .pfm in upper or lower case): values that are not finite are
///   unknown.
/// - Any other image, which must be gray with 8 or 16 bits: 0 is unknown.
///
/// Throws Error naming the file if it is missing, malformed or of another type.
cv::Mat readDisparity(const std::string& path, double divisor);

/// Converts disparities (CV_32FC1, px; not finite = none) to the CV_16UC1 format of KITTI: 256
/// times px, rounded. 0 = none, so no disparity is stored as 0.
cv::Mat toKittiDisparity(const cv::Mat& disparity);

}  // namespace cbmv
