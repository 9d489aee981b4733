#pragma once

#include <string>

namespace cbmv {

inline constexpr const char* kPresetHelp =
    "Parameters: a name such as balanced, quality or realtime, or the path of a YAML file";
inline constexpr const char* kForestHelp =
    "Forest: a name such as middlebury or middlebury_small, or the path of a file";

/// Path of a preset given by path or name (presets.h). Named presets are in config/, installed with
/// this program or in the source tree it was built from.
std::string presetFile(const std::string& preset);

/// The same for forests, in models/.
std::string forestFile(const std::string& forest);

}  // namespace cbmv
