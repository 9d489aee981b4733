#pragma once

#include <cstdint>
#include <vector>

#include <gtest/gtest.h>
#include <hwy/highway.h>

#include "support/scoped_simd_target.h"

namespace cbmv::test {

/// Every instruction set that is compiled in and supported by this machine, including emulated
/// vectors.
inline std::vector<std::int64_t> simdTargets() {
  std::vector<std::int64_t> targets = {HWY_EMU128};
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
    if (target != HWY_EMU128) {
      targets.push_back(target);
    }
  }
  return targets;
}

/// Runs a check on every instruction set.
template <typename Check>
void onEverySimdTarget(const Check& check) {
  for (const std::int64_t target : simdTargets()) {
    SCOPED_TRACE(hwy::TargetName(target));
    const ScopedSimdTarget scope(target);
    check();
  }
}

}  // namespace cbmv::test
