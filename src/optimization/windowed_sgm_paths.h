#pragma once

#include <cstdint>

#include "base/search_space.h"
#include "optimization/sgm_penalties.h"
#include "optimization/windowed_sgm_steps.h"

namespace cbmv {

/// Cost of a hypothesis that does not exist. Any value above all path costs plus a penalty (2 *
/// kMaxPathCost) has the same effect.
constexpr std::uint16_t kNoPath = 65535;

/// Common data of all paths along one axis, except the costs.
struct PathSetup {
  const SearchSpace* space = nullptr;
  SgmPenalties penalties{};
  StepMap steps;
};

}  // namespace cbmv
