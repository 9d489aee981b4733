#pragma once

#include <cstdint>
#include <cstring>
#include <fstream>
#include <limits>
#include <string>
#include <vector>

namespace cbmv {

/// Opens a regular file for reading, numbers in the "C" locale. Throws Error naming it otherwise,
/// and where it has more than `largest` bytes.
std::ifstream openForReading(const std::string& path,
                             std::uintmax_t largest = std::numeric_limits<std::uintmax_t>::max());

/// The same for a text, behind the byte order mark where it begins with one (as some editors
/// write).
std::ifstream openText(const std::string& path, std::uintmax_t largest);

/// All bytes of such a file.
std::vector<std::uint8_t> readBytes(const std::string& path, std::uintmax_t largest);

/// Makes the folder and those it lies in, where they are not there. Throws Error naming it when
/// that fails.
void makeFolder(const std::string& path);

/// Replaces the file's content. Throws Error naming the file when it cannot be written.
void writeFile(const std::string& path, const std::string& content);

/// The same through a new file beside it, so that an interruption leaves the old file whole. Links
/// are followed; what is no regular file is written to as it is.
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
