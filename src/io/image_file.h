#pragma once

#include <filesystem>
#include <string>

#include <opencv2/core.hpp>

#include "cbmv_stereo/gray_pair.h"

namespace cbmv {

/// Reads an image as its file holds it: CV_8U or CV_16U with one channel (gray) or three (blue,
/// green, red). Palettes become colors, transparency is dropped, and what a file says of its
/// orientation is ignored: it would turn the rows of a rectified pair.
/// Throws Error naming the file when it is missing or not an image, when its channels have other
/// than 8 or 16 bits, or when a PNG or JPEG claims to hold more than 2^27 pixels.
cv::Mat readImage(const std::string& path);

/// Reads a pair as the method takes it: readImage, then toGrayPair (gray_pair.h), which stretches
/// 16 bits. Throws Error naming both files when the sizes differ; else as readImage.
GrayPair readGrayPair(const std::string& left_path, const std::string& right_path);

/// Reads one image as CV_8UC1, a mask for example. Pairs are read by readGrayPair, which stretches
/// both images of 16 bits in the same way. Errors as for readImage.
cv::Mat readGreyImage(const std::string& path);

/// Reads an image as CV_8UC3, BGR, by toColor8 (gray_pair.h). Errors as for readImage.
cv::Mat readColorImage(const std::string& path);

/// Throws Error naming both files and sizes when `size`, of `file`, is not `expected`, of
/// `reference`.
void requireSameSize(const std::filesystem::path& file, const cv::Size& size,
                     const std::filesystem::path& reference, const cv::Size& expected);

/// Writes an image; the extension of `path` selects the format. Throws Error naming the file when
/// it cannot be written.
void writeImage(const std::string& path, const cv::Mat& image);

}  // namespace cbmv
