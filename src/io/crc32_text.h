#pragma once

#include <array>
#include <cstdio>
#include <string>

#include <zlib.h>

namespace cbmv {

/// CRC-32 of a text as eight hexadecimal digits.
inline std::string crc32Text(const std::string& text) {
  const auto crc =
      crc32_z(crc32(0, nullptr, 0), reinterpret_cast<const Bytef*>(text.data()), text.size());
  std::array<char, 9> digits{};
  std::snprintf(digits.data(), digits.size(), "%08lx", static_cast<unsigned long>(crc));
  return digits.data();
}

}  // namespace cbmv
