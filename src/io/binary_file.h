#pragma once

#include <cstdint>
#include <cstring>
#include <fstream>
#include <limits>
#include <string>
#include <vector>

namespace cbmv {

/// Opens a regular file for reading, with numbers in the "C" locale. Throws Error naming the file
/// if it cannot be opened or has more than `largest` bytes.
std::ifstream openForReading(const std::string& path,
                             std::uintmax_t largest = std::numeric_limits<std::uintmax_t>::max());

/// The same for a text file. Skips a byte order mark, which some editors write.
std::ifstream openText(const std::string& path, std::uintmax_t largest);

/// Reads all bytes of a file, with the errors of openForReading.
std::vector<std::uint8_t> readBytes(const std::string& path, std::uintmax_t largest);

/// Creates the folder and its parent folders if they do not exist. Throws Error naming the folder
/// on failure.
void makeFolder(const std::string& path);

/// Replaces the content of the file. Throws Error naming the file if it cannot be written.
void writeFile(const std::string& path, const std::string& content);

/// The same, but writes a new file beside it and renames it, so that an interruption leaves the old
/// file intact. Symbolic links are followed. Devices and pipes are written to directly.
void replaceFile(const std::string& path, const std::string& content);

inline void appendLittleEndian(float value, std::string& bytes) {
  std::uint32_t bits = 0;
  std::memcpy(&bits, &value, sizeof bits);
  for (int shift = 0; shift < 32; shift += 8) {
    bytes.push_back(static_cast<char>((bits >> shift) & 0xFFU));
  }
}

inline float floatFromBytes(const std::uint8_t* bytes, bool little_endian) {
  std::uint32_t bits = 0;
  for (int i = 0; i < 4; ++i) {
    bits |= static_cast<std::uint32_t>(bytes[i]) << (little_endian ? 8 * i : 24 - 8 * i);
  }
  float value = 0.0F;
  std::memcpy(&value, &bits, sizeof value);
  return value;
}

}  // namespace cbmv
