#pragma once

#include <string>

#include <opencv2/core.hpp>

namespace cbmv {

/// Reads a one-channel portable float map ("Pf") as CV_32FC1, top row first (the file holds the
/// bottom row first). The sign of the scale gives the byte order, its magnitude is ignored: values
/// are returned as stored, infinity included. The header may have comments (from # to the end of
/// the line, before a number) and line ends of Windows.
/// Throws Error naming the file when it is missing, is not such a map, has a side outside
/// 1..65535, or is not exactly as long as its header promises (checked before memory is taken).
cv::Mat readPfm(const std::string& path);

/// Writes a CV_32FC1 map as a little-endian "Pf" file with scale −1. Throws Error naming the file
/// when it cannot be written.
void writePfm(const std::string& path, const cv::Mat& map);

}  // namespace cbmv
