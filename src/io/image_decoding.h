#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <opencv2/imgcodecs.hpp>

namespace cbmv {

/// Largest image that is read, in pixels: 400 MB in color.
inline constexpr std::uint64_t kMaxImagePixels = std::uint64_t{1} << 27;

/// The number of pixels that the header of a PNG or JPEG declares. It is checked before memory is
/// allocated, because a file of some kilobytes can unpack to gigabytes. 0 for other formats, whose
/// size OpenCV limits, and for truncated headers.
std::uint64_t claimedPixels(const std::uint8_t* data, std::size_t size);

/// Decodes an image. Empty if OpenCV cannot decode it. `flags`: cv::ImreadModes.
cv::Mat decodeImage(const std::vector<std::uint8_t>& bytes, int flags);

/// The same for a file. Throws Error naming the file if it cannot be opened (OpenCV gives no
/// reason), or if its header declares more than kMaxImagePixels.
cv::Mat decodeImageFile(const std::string& path, int flags);

}  // namespace cbmv
