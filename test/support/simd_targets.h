#pragma once

#include <cstdint>
#include <vector>

#include <gtest/gtest.h>
#include <hwy/highway.h>

namespace cbmv::test {

/// Every instruction set that the vector code is compiled for and that this machine has, the
/// emulated vectors included.
inline std::vector<std::int64_t> simdTargets() {
  std::vector<std::int64_t> targets = {HWY_EMU128};
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
    if (target != HWY_EMU128) {
      targets.push_back(target);
    }
  }
  return targets;
}

/// While it lives, the vector code runs on `target`.
class ScopedSimdTarget {
 public:
  explicit ScopedSimdTarget(std::int64_t target) { choose(target); }
  ~ScopedSimdTarget() { choose(0); }
  ScopedSimdTarget(const ScopedSimdTarget&) = delete;
  ScopedSimdTarget& operator=(const ScopedSimdTarget&) = delete;

 private:
  /// 0: the best one.
  static void choose(std::int64_t target) {
    hwy::SetSupportedTargetsForTest(target);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
  }
};

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
