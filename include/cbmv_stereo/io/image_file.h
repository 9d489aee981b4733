#pragma once

#include <string>

#include <opencv2/core.hpp>

namespace cbmv {

/// Reads an image as CV_8UC1. Colour becomes grey by OpenCV's weights (0.299 R + 0.587 G + 0.114 B)
/// whatever the file format; 16-bit images are scaled to 8 bits.
/// Throws Error naming the file when it is missing or not an image, or when a PNG or JPEG claims to
/// hold more than 2^27 pixels.
cv::Mat readGreyImage(const std::string& path);

/// Reads an image as CV_8UC3, BGR. Errors as for readGreyImage.
cv::Mat readColorImage(const std::string& path);

/// Writes an image; the extension of `path` selects the format. Throws Error naming the file when
/// it cannot be written.
void writeImage(const std::string& path, const cv::Mat& image);

}  // namespace cbmv
