#pragma once

#include <string>

namespace cbmv {

inline constexpr const char* kPresetHelp =
    "Parameters: a name such as balanced, quality or realtime, or the path of a YAML file";
inline constexpr const char* kForestHelp =
    "Forest: a name such as middlebury or middlebury_small, or the path of a file";

/// The file of a preset that is given by its path or its name (presets.h). The presets that have
/// names are those of config/ that was installed with this program, or of the source tree that it
/// was built from.
std::string presetFile(const std::string& preset);

/// The same for forests, in models/.
std::string forestFile(const std::string& forest);

}  // namespace cbmv
