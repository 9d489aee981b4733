#pragma once

#include <filesystem>
#include <string>

#include <opencv2/core.hpp>

#include "cbmv_stereo/gray_pair.h"

namespace cbmv {

/// Reads an image with the depth of its file: CV_8U or CV_16U with one channel (gray) or three
/// channels (blue, green, red). Palettes become colors. Transparency is dropped. The orientation in
/// the file is ignored, because it would rotate the rows of a rectified pair.
///
/// Throws Error naming the file if
/// - it is missing or not an image,
/// - its channels do not have 8 or 16 bits,
/// - a PNG or JPEG declares more than 2^27 pixels.
cv::Mat readImage(const std::string& path);

/// Reads a pair with readImage and converts it with toGrayPair (gray_pair.h), which stretches 16
/// bits. Throws Error naming both files if the sizes differ, otherwise as readImage.
GrayPair readGrayPair(const std::string& left_path, const std::string& right_path);

/// Reads one image as CV_8UC1, for example a mask. Use readGrayPair for pairs: it stretches both
/// 16-bit images in the same way. Errors as in readImage.
cv::Mat readGrayImage(const std::string& path);

/// Reads an image as CV_8UC3 (BGR) with toColor8 (gray_pair.h). Errors as in readImage.
cv::Mat readColorImage(const std::string& path);

/// Throws Error naming both files and sizes if the `size` of `file` differs from the `expected`
/// size of `reference`.
void requireSameSize(const std::filesystem::path& file, const cv::Size& size,
                     const std::filesystem::path& reference, const cv::Size& expected);

/// Writes an image. The extension of `path` selects the format. Throws Error naming the file if it
/// cannot be written.
void writeImage(const std::string& path, const cv::Mat& image);

}  // namespace cbmv
