#pragma once

#include <fstream>
#include <sstream>
#include <string>

namespace cbmv {

inline std::string contentOf(const std::string& path) {
  std::ostringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

}  // namespace cbmv
