#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace cbmv {

struct ColoredPoint {
  float x, y, z;  ///< m
  std::uint8_t r, g, b;
};

/// Writes a point cloud as binary little-endian PLY with vertex properties x y z red green blue.
/// Throws Error naming the file when it cannot be written.
void writePly(const std::string& path, const std::vector<ColoredPoint>& points);

}  // namespace cbmv
