#pragma once

#include <cstdint>

namespace cbmv {

/// Minimum of the parabola through the costs at −1, 0 and 1; 0 where they have no strict minimum at
/// 0.
inline float parabolaMinimum(int before, int here, int after) {
  const int curvature = before - 2 * here + after;
  if (here > before || here > after || curvature == 0) {
    return 0;
  }
  return static_cast<float>(before - after) / static_cast<float>(2 * curvature);
}

/// Whether the column is one of an image of that width.
inline bool isColumn(int x, int width) { return x >= 0 && x < width; }

}  // namespace cbmv
