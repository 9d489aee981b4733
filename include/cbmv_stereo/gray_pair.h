#pragma once

#include <opencv2/core.hpp>

#include "cbmv_stereo/export.h"

// Images of any source as the 8-bit images that the method works on. Messages and files take the
// same functions.

namespace cbmv {

/// The pair that is matched: CV_8UC1 of one size.
struct GrayPair {
  cv::Mat left;
  cv::Mat right;
};

/// Converts a pair to gray with 8 bits. Each image is CV_8U or CV_16U with one channel (gray),
/// three (blue, green, red) or four (and alpha, ignored); both need not be alike. Color becomes
/// gray with the weights 0.299 R + 0.587 G + 0.114 B.
///
/// 16-bit images are stretched to 8 bits: the levels between the darkest and the brightest 0.1 % of
/// the pixels (of both images, where both have 16 bits) are mapped to 0 … 255. So 10, 12 or 16
/// significant bits keep their contrast. Images whose levels all fit 8 bits keep them unchanged.
///
/// An image that is gray with 8 bits already shares its memory with the result.
CBMV_API GrayPair toGrayPair(const cv::Mat& left, const cv::Mat& right);

/// Converts one image to gray as above, and keeps its bits: CV_8UC1 or CV_16UC1. May share memory
/// with `image`.
CBMV_API cv::Mat toGray(const cv::Mat& image);

/// Converts one image to three channels (blue, green, red) and keeps its bits. May share memory
/// with `image`.
CBMV_API cv::Mat toColor(const cv::Mat& image);

/// Converts one image to CV_8UC3 (blue, green, red); 16 bits are stretched as above, with one
/// stretch for all channels. May share memory with `image`.
CBMV_API cv::Mat toColor8(const cv::Mat& image);

}  // namespace cbmv
