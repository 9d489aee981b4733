#pragma once

#include <string>
#include <vector>

#include "cbmv_stereo/points.h"

namespace cbmv {

/// Writes a point cloud as binary little-endian PLY with the vertex properties x y z red green
/// blue. Throws Error naming the file if it cannot be written.
void writePly(const std::string& path, const std::vector<ColoredPoint>& points);

}  // namespace cbmv
