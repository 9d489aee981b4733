#pragma once

#include <string>

#include <opencv2/imgcodecs.hpp>

#include "binary_file.h"

namespace cbmv {

/// The image in a file; empty where OpenCV cannot decode it. Throws Error naming the file when it
/// cannot be opened, because OpenCV does not say why it fails. `flags`: cv::ImreadModes.
inline cv::Mat decodeImage(const std::string& path, int flags) {
  openForReading(path);
  try {
    return cv::imread(path, flags);
  } catch (const cv::Exception&) {
    return {};
  }
}

}  // namespace cbmv
