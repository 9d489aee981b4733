#pragma once

#include <string>

namespace cbmv {

/// Checks that a file can be written, before the work that creates its content: its folder exists
/// and accepts new files, and the file, if it exists, is a writable file or device and not a
/// folder. Leaves no files behind and changes no file. Does not detect a full disk. Throws Error
/// naming the file and what to do.
void requireWritableFile(const std::string& path);

/// Checks that a folder accepts new files, or can be created if it does not exist (it is not
/// created). Throws Error naming the folder and what to do.
void requireWritableFolder(const std::string& path);

}  // namespace cbmv
