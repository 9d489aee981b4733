#include "io/output_check.h"

#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <system_error>

#include <unistd.h>

#include "cbmv_stereo/error.h"

namespace cbmv {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const std::string& path, const std::string& what,
                       const std::string& remedy) {
  throw Error("Cannot write " + path + ": " + what + ". " + remedy);
}

std::string systemError() { return std::generic_category().message(errno); }

/// Creates a file, because permissions do not show read-only or special file systems.
void requireTakesFiles(const fs::path& folder, const std::string& path) {
  std::string probe = (folder / ".cbmv_write_check_XXXXXX").string();
  const int file = mkstemp(probe.data());
  if (file < 0) {
    fail(path,
         "no file can be created in the folder " + folder.string() + " (" + systemError() + ")",
         "Correct its permissions or give another path.");
  }
  close(file);
  unlink(probe.c_str());
}

/// Removes slashes at the end, because the path has no file name after them.
fs::path withoutEndSlash(const fs::path& path) {
  return path.has_filename() || !path.has_relative_path() ? path : path.parent_path();
}

}  // namespace

void requireWritableFile(const std::string& path) {
  std::error_code ignored;
  if (path.empty() || path.back() == '/' || fs::is_directory(path, ignored)) {
    fail(path.empty() ? "to an empty path" : path, "it is a folder, expected a file",
         "Give the path of a file.");
  }
  if (fs::exists(path, ignored) && access(path.c_str(), W_OK) != 0) {
    fail(path, "the file exists and is not writable (" + systemError() + ")",
         "Correct its permissions or give another path.");
  }
  if (fs::exists(path, ignored) && !fs::is_regular_file(path, ignored)) {
    return;  // a device or pipe needs no folder
  }
  const fs::path target = fs::weakly_canonical(path, ignored);  // the target of a link is replaced
  const fs::path folder = fs::absolute(target.empty() ? fs::path(path) : target).parent_path();
  if (!fs::is_directory(folder, ignored)) {
    fail(path, "there is no folder " + folder.string(), "Create it or give another path.");
  }
  requireTakesFiles(folder, path);
}

void requireWritableFolder(const std::string& path) {
  if (path.empty()) {
    fail("to an empty path", "a folder is expected", "Give the path of a folder.");
  }
  std::error_code ignored;
  fs::path folder = withoutEndSlash(fs::absolute(path));
  while (!fs::exists(folder, ignored) && folder.has_relative_path()) {
    folder = folder.parent_path();
  }
  if (!fs::is_directory(folder, ignored)) {
    fail(path, folder.string() + " is not a folder", "Give the path of a folder.");
  }
  requireTakesFiles(folder, path);
}

}  // namespace cbmv
