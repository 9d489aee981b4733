#include "tools/program_files.h"

#include <filesystem>
#include <system_error>

#include "cbmv_stereo/presets.h"

namespace cbmv {
namespace {

namespace fs = std::filesystem;

/// PREFIX/share/cbmv_stereo for a program in PREFIX/lib/cbmv_stereo (with ROS) or PREFIX/bin, else
/// the source tree.
fs::path shareFolder() {
  std::error_code ignored;
  const fs::path program = fs::read_symlink("/proc/self/exe", ignored).parent_path();
  for (const char* share : {"../../share/cbmv_stereo", "../share/cbmv_stereo"}) {
    const fs::path folder = (program / share).lexically_normal();
    if (fs::is_directory(folder / "config", ignored)) {
      return folder;
    }
  }
  return CBMV_SOURCE_TREE;
}

}  // namespace

std::string presetFile(const std::string& preset) {
  return presetPath(preset, (shareFolder() / "config").string());
}

std::string forestFile(const std::string& forest) {
  return forestPath(forest, (shareFolder() / "models").string());
}

}  // namespace cbmv
