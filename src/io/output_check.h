#pragma once

#include <string>

namespace cbmv {

/// Checks that a file can be written, before the work whose result it will hold: its folder exists
/// and takes new files, and the file, where there is one already, is a writable file or device and
/// no folder. Leaves nothing behind and changes no file. A disk that is full is not found.
/// Throws Error naming the file and what to do.
void requireWritableFile(const std::string& path);

/// Checks that a folder takes new files, or can be made where it does not exist (it is not made).
/// Throws Error naming the folder and what to do.
void requireWritableFolder(const std::string& path);

}  // namespace cbmv
