#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <opencv2/imgcodecs.hpp>

#include "io/binary_file.h"
#include "io/image_size.h"

#include "cbmv_stereo/error.h"

namespace cbmv {

/// Decodes an image. Empty if OpenCV cannot decode it. `flags`: cv::ImreadModes.
inline cv::Mat decodeImage(const std::vector<std::uint8_t>& bytes, int flags) {
  try {
    return bytes.empty() ? cv::Mat() : cv::imdecode(bytes, flags);
  } catch (const cv::Exception&) {
    return {};
  }
}

/// The same for a file. Throws Error naming the file if it cannot be opened (OpenCV gives no
/// reason), or if its header declares more than kMaxImagePixels.
inline cv::Mat decodeImageFile(const std::string& path, int flags) {
  constexpr std::uintmax_t largest_file = 1U << 30;
  const std::vector<std::uint8_t> bytes = readBytes(path, largest_file);
  if (claimedPixels(bytes.data(), bytes.size()) > kMaxImagePixels) {
    throw Error("Cannot read " + path + ": its header has " +
                std::to_string(claimedPixels(bytes.data(), bytes.size())) +
                " pixels, expected at most " + std::to_string(kMaxImagePixels) +
                ". Use a smaller image.");
  }
  return decodeImage(bytes, flags);
}

}  // namespace cbmv
