#include "cbmv_stereo/forest/forest_evaluator.h"

#include <vector>

#include <gtest/gtest.h>

#include "support/random_forest.h"

namespace cbmv::test {
namespace {

class ForestEvaluatorTest : public testing::TestWithParam<int> {};

TEST_P(ForestEvaluatorTest, EqualsTreeWalk) {
  const int count = GetParam();
  std::mt19937 random(9);
  std::vector<std::vector<std::uint8_t>> columns(kFeatureCount, std::vector<std::uint8_t>(count));
  std::array<const std::uint8_t*, kFeatureCount> codes{};
  for (int f = 0; f < kFeatureCount; ++f) {
    for (std::uint8_t& code : columns[f]) {
      code = static_cast<std::uint8_t>(random() % 256);
    }
    codes[f] = columns[f].data();
  }
  for (const int trees : {1, 17, 90}) {
    const Forest forest = makeForest(trees, Forest::kMaxDepth, 11);
    std::vector<std::uint8_t> costs(count + 1, 42);
    ForestEvaluator(forest).evaluate(codes, count, costs.data());
    for (int i = 0; i < count; ++i) {
      ASSERT_EQ(costs[i], naiveForestCost(forest, [&](int f) { return columns[f][i]; }));
    }
    EXPECT_EQ(costs[count], 42) << "wrote behind the end";
  }
}

INSTANTIATE_TEST_SUITE_P(Counts, ForestEvaluatorTest,
                         testing::Values(0, 1, 15, 64, 511, 512, 513, 1500));

}  // namespace
}  // namespace cbmv::test
