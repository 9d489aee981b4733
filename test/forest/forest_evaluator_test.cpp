#include "forest/forest_evaluator.h"

#include <algorithm>
#include <array>
#include <vector>

#include <gtest/gtest.h>

#include "support/random_forest.h"
#include "support/simd_targets.h"

namespace cbmv::test {
namespace {

using CodeColumns = std::vector<std::vector<std::uint8_t>>;

CodeColumns randomCodes(int count) {
  std::mt19937 random(9);
  CodeColumns columns(kFeatureCount, std::vector<std::uint8_t>(count));
  for (std::vector<std::uint8_t>& column : columns) {
    for (std::uint8_t& code : column) {
      code = static_cast<std::uint8_t>(random() % 256);
    }
  }
  return columns;
}

/// Codes of `count` hypotheses, starting at `first`.
CodeBlock makeBlock(const CodeColumns& columns, int first, int count) {
  CodeBlock block{};
  for (int f = 0; f < kFeatureCount; ++f) {
    for (int i = 0; i < count; ++i) {
      block.lines[f][i] = static_cast<std::int8_t>(columns[f][first + i] - 128);
    }
  }
  return block;
}

void expectTreeWalk(const Forest& forest, const CodeColumns& columns) {
  const int count = static_cast<int>(columns[0].size());
  std::vector<std::uint8_t> expected(count);
  for (int i = 0; i < count; ++i) {
    expected[i] = naiveForestCost(forest, [&](int f) { return columns[f][i]; });
  }
  onEverySimdTarget([&] {
    std::vector<std::uint8_t> costs(count + 1, 42);
    const ForestEvaluator evaluator(forest);
    for (int first = 0; first < count; first += CodeBlock::kHypotheses) {
      const int hypotheses = std::min(CodeBlock::kHypotheses, count - first);
      evaluator.evaluate(makeBlock(columns, first, hypotheses), hypotheses, &costs[first]);
    }
    EXPECT_EQ(costs.back(), 42) << "wrote behind the end";
    costs.pop_back();
    EXPECT_EQ(costs, expected);
  });
}

class ForestEvaluatorTest : public testing::TestWithParam<int> {};

TEST_P(ForestEvaluatorTest, EqualsTreeWalk) {
  const CodeColumns codes = randomCodes(GetParam());
  for (const int trees : {1, 17, 90}) {
    expectTreeWalk(makeForest(trees, Forest::kMaxDepth, 11), codes);
  }
}

INSTANTIATE_TEST_SUITE_P(Counts, ForestEvaluatorTest,
                         testing::Values(0, 1, 15, 64, 511, 512, 513, 1500));

TEST(ForestEvaluator, EachDepthAlone) {
  for (int depth = 1; depth <= Forest::kMaxDepth; ++depth) {
    Forest forest = makeForest(Forest::kMaxDepth * 12, Forest::kMaxDepth, 23);
    forest.trees.erase(std::remove_if(forest.trees.begin(), forest.trees.end(),
                                      [depth](const ObliviousTree& tree) {
                                        return static_cast<int>(tree.levels.size()) != depth;
                                      }),
                       forest.trees.end());
    ASSERT_EQ(forest.trees.size(), 12U);
    expectTreeWalk(forest, randomCodes(300));
  }
}

TEST(ForestEvaluator, ThresholdsAtTheEndsOfTheRange) {
  Forest forest = makeForest(40, 5, 31);
  int level_number = 0;
  for (ObliviousTree& tree : forest.trees) {
    for (ObliviousTree::Level& level : tree.levels) {
      level.threshold = std::array<std::uint8_t, 5>{0, 1, 127, 128, 255}[level_number++ % 5];
    }
  }
  CodeColumns codes = randomCodes(300);
  for (std::vector<std::uint8_t>& column : codes) {
    for (std::uint8_t& code : column) {
      code = std::array<std::uint8_t, 6>{0, 1, 127, 128, 254, 255}[code % 6];
    }
  }
  expectTreeWalk(forest, codes);
}

/// The sum of its leaves needs more than 16 bits.
TEST(ForestEvaluator, LargestForest) {
  Forest forest = makeForest(Forest::kMaxTrees, 3, 17);
  forest.leaf_unit = 1.0 / 8192;
  for (ObliviousTree& tree : forest.trees) {
    for (std::int8_t& leaf : tree.leaves) {
      leaf = static_cast<std::int8_t>(leaf < 0 ? -128 : 127);
    }
  }
  for (const int bias : {-3, 3}) {
    for (std::size_t t = 0; t < forest.trees.size(); t += 2) {
      std::fill(forest.trees[t].leaves.begin(), forest.trees[t].leaves.end(),
                static_cast<std::int8_t>(bias < 0 ? -128 : 127));
      forest.trees[t].leaves[1] = static_cast<std::int8_t>(bias < 0 ? 127 : -128);
    }
    expectTreeWalk(forest, randomCodes(100));
  }
}

}  // namespace
}  // namespace cbmv::test
