#pragma once

#include <cstddef>
#include <cstdint>

namespace cbmv {

/// Pixels of the largest image that is read: 400 MB in colour.
inline constexpr std::uint64_t kMaxImagePixels = std::uint64_t{1} << 27;

/// Pixels that the header of a PNG or JPEG promises, before any memory is taken for them: some
/// kilobytes can promise, and unpack to, gigabytes. 0 for other formats, whose size OpenCV bounds,
/// and where the header is cut off.
std::uint64_t claimedPixels(const std::uint8_t* data, std::size_t size);

}  // namespace cbmv
