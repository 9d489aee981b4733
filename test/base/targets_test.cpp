// Instruction sets that are compiled in and selected at run time.

#include <cstdio>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <hwy/highway.h>

#include "support/simd_targets.h"

namespace cbmv::test {
namespace {

std::vector<std::string> targetNames() {
  std::vector<std::string> names;
  for (const std::int64_t target : simdTargets()) {
    names.emplace_back(hwy::TargetName(target));
  }
  return names;
}

/// Instruction sets of every processor in use, and emulated vectors.
TEST(SimdTargets, HoldTheLeastOfTheProcessor) {
  for (const std::string& name : targetNames()) {
    std::printf("[  TARGET  ] %s\n", name.c_str());
  }
#if HWY_ARCH_ARM_A64
  EXPECT_THAT(targetNames(), testing::Contains("NEON"));
#elif HWY_ARCH_X86_64
  EXPECT_THAT(targetNames(), testing::Contains("SSSE3"));
#endif
  EXPECT_THAT(targetNames(), testing::Contains("EMU128"));
}

/// Tests that do not select an instruction set run on real vectors.
TEST(SimdTargets, TheBestIsNotTheEmulatedOne) {
  EXPECT_NE(hwy::SupportedAndGeneratedTargets().front(), HWY_EMU128);
}

}  // namespace
}  // namespace cbmv::test
