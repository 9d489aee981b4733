#pragma once

#include <string>

#include "forest/forest.h"

#include "cbmv_stereo/forest.h"

namespace cbmv {

/// Reads the file that writeForest writes, or a model of XGBoost (docs/forest.md has both formats).
/// Throws Error that names the file and what is wrong: not there, not a forest, another version,
/// damaged, out of range.
Forest readForest(const std::string& path);

/// The same from the text of the file; `file_name` is for the forest's name and for messages.
Forest parseForest(const std::string& text, const std::string& file_name);

/// Throws Error if the file cannot be written, or could not be read again: see validateForest, and
/// the size of 64 MiB.
void writeForest(const Forest& forest, const std::string& path);

/// The checksum that the file holds: eight digits that change with the forest's answers.
std::string forestChecksum(const Forest& forest);

/// Throws Error that says what is wrong with it, if anything: sizes and ranges of all parts.
void validateForest(const Forest& forest, const std::string& file_name);

}  // namespace cbmv
