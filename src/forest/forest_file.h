#pragma once

#include <string>

#include "forest/forest.h"

#include "cbmv_stereo/forest.h"

namespace cbmv {

/// Reads a file of writeForest or a model of XGBoost (docs/forest.md describes both formats).
/// Throws Error that names the file if it is missing, damaged, no forest, of another version, or
/// has values out of range.
Forest readForest(const std::string& path);

/// Reads a forest from the text of a file. `file_name` is the name of the forest and is used in
/// messages.
Forest parseForest(const std::string& text, const std::string& file_name);

/// Throws Error if the file cannot be written, or if it could not be read again: see
/// validateForest; the limit is 64 MiB.
void writeForest(const Forest& forest, const std::string& path);

/// The checksum in the file: eight hexadecimal digits that depend on everything that affects the
/// results of the forest.
std::string forestChecksum(const Forest& forest);

/// Throws Error if the size or the range of any part is invalid. The text says which.
void validateForest(const Forest& forest, const std::string& file_name);

}  // namespace cbmv
