#pragma once

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <string>

namespace cbmv {

/// Returns whether the path ends with `extension` (".pfm"), in upper or lower case.
inline bool hasExtension(const std::filesystem::path& path, const std::string& extension) {
  const std::string own = path.extension().string();
  return std::equal(
      own.begin(), own.end(), extension.begin(), extension.end(),
      [](unsigned char a, unsigned char b) { return std::tolower(a) == std::tolower(b); });
}

}  // namespace cbmv
