#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "optimization/sgm_penalties.h"

namespace cbmv {

/// Path costs are signed, because not every instruction set compares unsigned 16-bit lanes.
using PathCost = std::int16_t;

/// Larger than every path cost. A penalty can be added without overflow.
constexpr PathCost kGuard = kMaxPathCost + 1;

/// Penalties for the hypotheses of a row of pixels. P1 of hypothesis h of the pixel in column i is
/// at p1[e] + i * step + h, P2 is at p2[e] + i * step + h. e is 1 if edges[i] is not zero,
/// otherwise 0.
struct RowPenalties {
  const std::uint8_t* edges;  // in the reference image
  std::array<const PathCost*, 2> p1;
  std::array<const PathCost*, 2> p2;
  std::ptrdiff_t step;
  /// Rise of the surface from the previous pixel of the path in disparities, in {-1, 0, 1}.
  const std::int8_t* rises;
};

/// Pixels of a row, from the first column on.
template <typename Cost>
struct PathPixels {
  const Cost* costs;
  std::uint16_t* sums;  // sums of the path costs
  int columns;
  int disparities;
};

/// State of neighboring paths. The costs of path i start at i * stride. All elements between the
/// costs of different paths are kGuard; there are at least two on each side.
struct PathEnds {
  PathCost* previous;
  PathCost* current;  // costs of the pixel that is being added
  PathCost* lowest;   // lowest previous cost of each path, then its lowest current cost
  std::ptrdiff_t stride;
};

}  // namespace cbmv
