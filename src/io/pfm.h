#pragma once

#include <string>

#include <opencv2/core.hpp>

namespace cbmv {

/// Whether the name of a file ends with .pfm, in upper or lower case.
bool isPfmName(const std::string& path);

/// Reads a one-channel portable float map ("Pf") as CV_32FC1, top row first (the file has the
/// bottom row first). The sign of the scale gives the byte order; its magnitude is ignored. Values
/// are returned as stored, including infinity. The header may have comments (from # to the end of
/// the line, before a number) and Windows line ends.
///
/// Throws Error naming the file if
/// - it is missing or not a "Pf" map,
/// - a side is outside of 1..65535,
/// - its length differs from the length in its header (checked before memory is allocated).
cv::Mat readPfm(const std::string& path);

/// Writes a CV_32FC1 map as a little-endian "Pf" file with scale −1. Throws Error naming the file
/// if it cannot be written.
void writePfm(const std::string& path, const cv::Mat& map);

}  // namespace cbmv
