#include "io/image_decoding.h"

#include <algorithm>
#include <array>

#include "io/binary_file.h"

#include "cbmv_stereo/error.h"

namespace cbmv {
namespace {

/// The bytes of a file, which may be truncated.
struct Bytes {
  const std::uint8_t* data;
  std::size_t size;

  std::uint64_t bigEndian(std::size_t place, int count) const {
    std::uint64_t value = 0;
    for (int i = 0; i < count; ++i) {
      value = value << 8 | data[place + i];
    }
    return value;
  }
};

constexpr std::array<std::uint8_t, 8> kPngSignature = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};

/// The first chunk, IHDR, begins with width and height.
std::uint64_t pngPixels(const Bytes& file) {
  constexpr std::size_t width_place = 16;
  return file.size < width_place + 8
             ? 0
             : file.bigEndian(width_place, 4) * file.bigEndian(width_place + 4, 4);
}

/// Frame headers are 0xC0 … 0xCF except 0xC4, 0xC8 and 0xCC, which are tables and an extension.
bool isFrameHeader(std::uint8_t marker) {
  return marker >= 0xc0 && marker <= 0xcf && marker != 0xc4 && marker != 0xc8 && marker != 0xcc;
}

/// Markers 0x01 and 0xD0 … 0xD9 have no content. The others have a length that includes its own
/// bytes.
bool standsAlone(std::uint8_t marker) {
  return marker == 0x01 || (marker >= 0xd0 && marker <= 0xd9);
}

/// The pixels of the largest frame header before the image data.
std::uint64_t jpegPixels(const Bytes& file) {
  std::uint64_t pixels = 0;
  std::size_t place = 2;
  while (place + 4 <= file.size) {
    const std::uint8_t marker = file.data[place + 1];
    if (file.data[place] != 0xff || marker == 0xff || marker == 0x00) {
      ++place;  // fill bytes, and bytes that decoders skip
      continue;
    }
    if (isFrameHeader(marker) && place + 9 <= file.size) {
      pixels = std::max(pixels, file.bigEndian(place + 5, 2) * file.bigEndian(place + 7, 2));
    }
    if (marker == 0xda) {  // start of the image data
      break;
    }
    place += 2 + (standsAlone(marker) ? 0 : file.bigEndian(place + 2, 2));
  }
  return pixels;
}

}  // namespace

std::uint64_t claimedPixels(const std::uint8_t* data, std::size_t size) {
  const Bytes file{data, size};
  if (size >= kPngSignature.size() &&
      std::equal(kPngSignature.begin(), kPngSignature.end(), data)) {
    return pngPixels(file);
  }
  const bool is_jpeg = size >= 2 && data[0] == 0xff && data[1] == 0xd8;
  return is_jpeg ? jpegPixels(file) : 0;
}

cv::Mat decodeImage(const std::vector<std::uint8_t>& bytes, int flags) {
  try {
    return bytes.empty() ? cv::Mat() : cv::imdecode(bytes, flags);
  } catch (const cv::Exception&) {
    return {};
  }
}

cv::Mat decodeImageFile(const std::string& path, int flags) {
  constexpr std::uintmax_t largest_file = 1U << 30;
  const std::vector<std::uint8_t> bytes = readBytes(path, largest_file);
  const std::uint64_t pixels = claimedPixels(bytes.data(), bytes.size());
  if (pixels > kMaxImagePixels) {
    throw Error("Cannot read " + path + ": its header has " + std::to_string(pixels) +
                " pixels, expected at most " + std::to_string(kMaxImagePixels) +
                ". Use a smaller image.");
  }
  return decodeImage(bytes, flags);
}

}  // namespace cbmv
