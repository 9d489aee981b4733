#pragma once

#include <string>

#include "cbmv_stereo/export.h"

namespace cbmv {

/// The file of a preset that a user gives by its path or by its name: a text with a slash or the
/// ending .yaml is a path and comes back as it is, else NAME.yaml in `folder`, else a file of this
/// name here. Throws Error that lists the names in `folder` if there is none.
CBMV_API std::string presetPath(const std::string& preset, const std::string& folder);

/// The same for forests: .forest in place of .yaml.
CBMV_API std::string forestPath(const std::string& forest, const std::string& folder);

}  // namespace cbmv
