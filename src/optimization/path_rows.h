#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "optimization/sgm_penalties.h"

namespace cbmv {

/// Costs of paths are signed, because not every instruction set compares unsigned 16-bit lanes.
using PathCost = std::int16_t;

/// Above every path cost, and still representable with a penalty on top.
constexpr PathCost kGuard = kMaxPathCost + 1;

/// Penalties of the hypotheses of a row of pixels. Those of hypothesis h of the pixel in column i
/// start at p1[e] + i * step + h (p2 likewise), where e is 1 if edges[i] is not zero, else 0.
struct RowPenalties {
  const std::uint8_t* edges;  // in the reference image
  std::array<const PathCost*, 2> p1;
  std::array<const PathCost*, 2> p2;
  std::ptrdiff_t step;
  /// Disparities that the surface rises from the previous pixel of the path, in {-1, 0, 1}.
  const std::int8_t* rises;
};

/// Pixels of a row, by column from the first one on.
template <typename Cost>
struct PathPixels {
  const Cost* costs;
  std::uint16_t* sums;  // of the costs of the paths
  int columns;
  int disparities;
};

/// Where neighbouring paths have got to. The costs of path i start at i * stride; the elements
/// before them and behind them, up to the next path, are kGuard; there are at least two on each side.
struct PathEnds {
  PathCost* previous;
  PathCost* current;  // of the pixel to be added
  PathCost* lowest;   // of each path's previous costs, then of its current ones
  std::ptrdiff_t stride;
};

}  // namespace cbmv
