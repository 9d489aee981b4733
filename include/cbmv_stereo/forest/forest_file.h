#pragma once

#include <string>

#include "cbmv_stereo/forest/forest.h"

namespace cbmv {

/// Reads the file that writeForest writes (docs/forest.md has the format). Throws Error that names
/// the file and what is wrong: not there, not a forest, another version, damaged, out of range.
Forest readForest(const std::string& path);

/// Throws Error if the file cannot be written.
void writeForest(const Forest& forest, const std::string& path);

/// The checksum that the file holds: eight digits that change with the forest's answers.
std::string forestChecksum(const Forest& forest);

/// Throws Error that says what is wrong with it, if anything: sizes and ranges of all parts.
void validateForest(const Forest& forest, const std::string& file_name);

}  // namespace cbmv
