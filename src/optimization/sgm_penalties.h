#pragma once

#include <array>
#include <cstdint>

#include "cbmv_stereo/options.h"

namespace cbmv {

/// Upper bound of all SGM path costs (sgmCostBound).
constexpr int kMaxPathCost = 16383;

/// Penalties in units of 1/255, indexed by the number of images that have an edge.
struct SgmPenalties {
  std::array<std::int16_t, 3> p1;
  std::array<std::int16_t, 3> p2;
};

/// Computes the penalties. P1 is also divided by `p1_divisor`.
SgmPenalties makePenalties(const SgmOptions& options, double p1_divisor);

/// Upper bound of a cost after `iterations` runs on costs of at most 255, in units of 1/255: each
/// run adds at most P2. Must be ≤ 16383, so that the sum of four paths fits 16 bits.
int sgmCostBound(const SgmOptions& options);

/// Throws Error if the options are invalid.
void checkSgmOptions(const SgmOptions& options);

}  // namespace cbmv
