#include "forest/tree_walker.h"

#include <array>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "forest/forest_evaluator.h"
#include "support/random_forest.h"

namespace cbmv::test {
namespace {

/// Integers, so that many values equal a threshold.
class Values {
 public:
  explicit Values(int count) : columns_(kFeatureCount, std::vector<float>(count)) {
    std::mt19937 random(5);
    for (std::vector<float>& column : columns_) {
      for (float& value : column) {
        value = static_cast<float>(static_cast<int>(random() % 21) - 10);
      }
    }
  }

  std::array<const float*, kFeatureCount> lines() const {
    std::array<const float*, kFeatureCount> lines{};
    for (int f = 0; f < kFeatureCount; ++f) {
      lines[f] = columns_[f].data();
    }
    return lines;
  }

  double naive(const Forest& forest, int i) const {
    return naiveProbability(forest, [&](int f) { return columns_[f][i]; });
  }

 private:
  std::vector<std::vector<float>> columns_;
};

class TreeWalkerTest : public testing::TestWithParam<int> {};

TEST_P(TreeWalkerTest, EqualsTheNaiveWalk) {
  const int count = GetParam();
  const Values values(count);
  for (const ForestOutput output : {ForestOutput::kLogOdds, ForestOutput::kProbability}) {
    Forest forest = makeGeneralForest(9, 60, 3);
    forest.output = output;
    std::vector<float> probabilities(count + 1, 42);
    TreeWalker(forest).evaluate(values.lines(), count, probabilities.data());
    EXPECT_EQ(probabilities.back(), 42) << "wrote behind the end";
    for (int i = 0; i < count; ++i) {
      ASSERT_NEAR(probabilities[i], values.naive(forest, i), 1e-6) << i;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Counts, TreeWalkerTest, testing::Values(0, 1, 15, 16, 17, 256, 600));

TEST(TreeWalker, TreesOfOneLeaf) {
  const Values values(20);
  const Forest forest = makeGeneralForest(3, 0, 4);
  std::vector<float> probabilities(20);
  TreeWalker(forest).evaluate(values.lines(), 20, probabilities.data());
  EXPECT_NEAR(probabilities[19], values.naive(forest, 0), 1e-6);
}

TEST(TreeWalker, IsEmptyWithoutGeneralTrees) {
  EXPECT_TRUE(TreeWalker(makeForest(3, 3, 1)).empty());
  EXPECT_FALSE(TreeWalker(makeGeneralForest(3, 3, 1)).empty());
}

/// The evaluator converts the walker's probabilities to costs.
TEST(TreeWalker, CostsAreOneMinusProbability) {
  const int count = 300;
  const Values values(count);
  Forest forest = makeGeneralForest(9, 60, 3);
  for (const ForestOutput output : {ForestOutput::kLogOdds, ForestOutput::kProbability}) {
    forest.output = output;
    const ForestEvaluator evaluator(forest);
    EXPECT_TRUE(evaluator.wantsValues());
    std::vector<std::uint8_t> costs(count);
    evaluator.evaluate(values.lines(), count, costs.data());
    for (int i = 0; i < count; ++i) {
      ASSERT_NEAR(costs[i], 255 * (1 - values.naive(forest, i)), 0.5001) << i;
    }
  }
}

}  // namespace
}  // namespace cbmv::test
