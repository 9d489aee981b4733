#pragma once

#include <cstdint>

#include "base/search_space.h"
#include "optimization/sgm_penalties.h"
#include "optimization/windowed_sgm_steps.h"

namespace cbmv {

/// A cost of a hypothesis that there is not. Whatever is above every path cost with a penalty on
/// top, 2 * kMaxPathCost, does as well.
constexpr std::uint16_t kNoPath = 65535;

/// What all paths of one axis have in common beside the costs.
struct PathSetup {
  const SearchSpace* space = nullptr;
  SgmPenalties penalties{};
  StepMap steps;
};

}  // namespace cbmv
