#include "io/other_file.h"

#include <filesystem>

#include "cbmv_stereo/error.h"

namespace cbmv {
namespace {

namespace fs = std::filesystem;

/// Absolute path, with symbolic links resolved as far as the path exists.
std::string realPath(const std::string& path) {
  std::error_code ignored;
  const fs::path real = fs::weakly_canonical(fs::absolute(path), ignored);
  return real.empty() ? path : real.string();
}

}  // namespace

bool isSameFile(const std::string& a, const std::string& b) {
  std::error_code missing;
  return fs::equivalent(a, b, missing) || realPath(a) == realPath(b);
}

void requireOtherFile(const std::string& input, const std::string& output) {
  const std::string parts = realPath(output) + ".part.";
  const bool is_part = realPath(input).compare(0, parts.size(), parts) == 0;
  if (isSameFile(input, output) || is_part) {
    throw Error("the output " + output + " would overwrite the input " + input +
                ". Choose another name for the output.");
  }
}

void requireOtherFiles(const std::vector<std::string>& inputs,
                       const std::vector<std::string>& outputs) {
  for (const std::string& output : outputs) {
    for (const std::string& input : inputs) {
      if (!input.empty() && !output.empty()) {
        requireOtherFile(input, output);
      }
    }
  }
}

}  // namespace cbmv
