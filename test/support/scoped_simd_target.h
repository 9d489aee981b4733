#pragma once

#include <cstdint>

#include <hwy/highway.h>

namespace cbmv::test {

/// Runs the vector code on `target` during its lifetime.
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

}  // namespace cbmv::test
