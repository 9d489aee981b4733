#pragma once

#include <opencv2/core.hpp>

#include "cbmv_stereo/export.h"

// Converts images to the 8-bit gray images that the method uses. The same functions serve messages
// and files.

namespace cbmv {

/// The pair to match: two CV_8UC1 images of the same size.
struct GrayPair {
  cv::Mat left;
  cv::Mat right;
};

/// Converts a pair to 8-bit gray. Each image is CV_8U or CV_16U with one channel (gray), three
/// channels (blue, green, red) or four channels (the fourth is alpha and is ignored). The two
/// images may have different types. Color becomes gray as 0.299 R + 0.587 G + 0.114 B.
///
/// 16-bit images are stretched to 8 bits: the levels between the darkest and the brightest 0.1 % of
/// the pixels are mapped to 0 … 255. If both images have 16 bits, one stretch is computed from
/// both. So images with 10, 12 or 16 significant bits keep their contrast. Images whose levels all
/// fit into 8 bits are not stretched.
///
/// An image that already is 8-bit gray shares its memory with the result.
CBMV_API GrayPair toGrayPair(const cv::Mat& left, const cv::Mat& right);

/// Converts one image to gray as above. The depth is kept: CV_8UC1 or CV_16UC1. The result may
/// share memory with `image`.
CBMV_API cv::Mat toGray(const cv::Mat& image);

/// Converts one image to three channels (blue, green, red). The depth is kept. The result may share
/// memory with `image`.
CBMV_API cv::Mat toColor(const cv::Mat& image);

/// Converts one image to CV_8UC3 (blue, green, red). 16 bits are stretched as above, with one
/// stretch for all channels. The result may share memory with `image`.
CBMV_API cv::Mat toColor8(const cv::Mat& image);

}  // namespace cbmv
