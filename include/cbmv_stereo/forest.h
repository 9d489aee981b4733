#pragma once

#include <memory>
#include <string>

#include "cbmv_stereo/export.h"

namespace cbmv {

/// A trained forest, and the forests that were trained on its maps. StereoMatcher takes it; several
/// matchers can share one.
struct Forest;

/// Reads the file of a forest. Throws Error that names the file and what is wrong: not
/// there, not a forest, another version, damaged, out of range.
CBMV_API std::shared_ptr<const Forest> loadForest(const std::string& path);

}  // namespace cbmv
