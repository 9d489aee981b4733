#pragma once

#include <string>

#include "cbmv_stereo/export.h"

namespace cbmv {

/// Finds the file of a preset, given by its path or its name. A text with a slash or the ending
/// .yaml is a path and is returned unchanged. A name is searched as NAME.yaml in `folder`, then as
/// a file NAME in the working directory. Throws Error that lists the names in `folder` if there is
/// none.
CBMV_API std::string presetPath(const std::string& preset, const std::string& folder);

/// The same for forests, with the ending .forest.
CBMV_API std::string forestPath(const std::string& forest, const std::string& folder);

}  // namespace cbmv
