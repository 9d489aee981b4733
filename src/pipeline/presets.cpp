#include "cbmv_stereo/presets.h"

#include <filesystem>
#include <set>
#include <system_error>

#include "cbmv_stereo/error.h"

namespace cbmv {
namespace {

namespace fs = std::filesystem;

/// A kind of file that is installed with the program.
struct NamedFiles {
  const char* what;
  const char* ending;
  const char* path;  ///< the alternative, for error messages
};

constexpr NamedFiles kPresets = {"preset", ".yaml", "the path of a YAML file"};
constexpr NamedFiles kForests = {"forest", ".forest", "the path of a forest file"};

std::string namesIn(const std::string& folder, const std::string& ending) {
  std::set<std::string> names;
  std::error_code no_folder;
  for (const auto& file : fs::directory_iterator(folder, no_folder)) {
    if (file.path().extension() == ending) {
      names.insert(file.path().stem().string());
    }
  }
  std::string list;
  for (const std::string& name : names) {
    list += (list.empty() ? "" : ", ") + name;
  }
  return list.empty() ? "none in " + folder : list;
}

std::string pathOf(const NamedFiles& files, const std::string& given, const std::string& folder) {
  if (given.find('/') != std::string::npos || fs::path(given).extension() == files.ending) {
    return given;
  }
  std::error_code ignored;
  std::string named = (fs::path(folder) / (given + files.ending)).string();
  if (fs::exists(named, ignored)) {
    return named;
  }
  if (fs::is_regular_file(given, ignored)) {
    return given;
  }
  throw Error(std::string("unknown ") + files.what + " '" + given + "', expected a name (" +
              namesIn(folder, files.ending) + ") or " + files.path);
}

}  // namespace

std::string presetPath(const std::string& preset, const std::string& folder) {
  return pathOf(kPresets, preset, folder);
}

std::string forestPath(const std::string& forest, const std::string& folder) {
  return pathOf(kForests, forest, folder);
}

}  // namespace cbmv
