#pragma once

#include <memory>
#include <string>

#include "cbmv_stereo/export.h"

namespace cbmv {

/// A trained forest, together with the forests that were trained on its maps. StereoMatcher uses
/// it. Several matchers can share one forest.
struct Forest;

/// Reads a forest file. Throws Error with the name of the file if the file is missing, damaged, no
/// forest, of another version, or has values out of range.
CBMV_API std::shared_ptr<const Forest> loadForest(const std::string& path);

}  // namespace cbmv
