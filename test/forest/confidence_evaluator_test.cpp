#include "forest/confidence_evaluator.h"

#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "support/random_forest.h"
#include "support/simd_targets.h"

namespace cbmv::test {
namespace {

constexpr int kQueries = ConfidenceEvaluator::kQueries;

/// A full block of random codes, with all values equally likely, including the limits.
ConfidenceCodes randomCodes(const ConfidenceForest& forest) {
  std::mt19937 random(5);
  ConfidenceCodes codes(forest);
  for (std::size_t f = 0; f < forest.feature_names.size(); ++f) {
    for (int i = 0; i < kQueries; ++i) {
      const int code = static_cast<int>(random() % 256);
      const int end = random() % 2 == 0 ? 0 : 255;
      codes.line(static_cast<int>(f))[i] =
          static_cast<std::int8_t>((random() % 2 == 0 ? code : end) - 128);
    }
  }
  return codes;
}

void expectTreeWalk(const ConfidenceForest& forest, int count) {
  ConfidenceCodes codes = randomCodes(forest);
  onEverySimdTarget([&] {
    const ConfidenceEvaluator evaluator(forest);
    std::vector<float> probabilities(count + 1, 42);
    evaluator.evaluate(codes, count, probabilities.data());
    std::vector<std::uint16_t> scores(kQueries);
    evaluator.score(codes, count, scores.data());
    for (int i = 0; i < count; ++i) {
      const double log_odds = naiveLogOdds(forest, [&](int f) { return codes.line(f)[i] + 128; });
      ASSERT_NEAR(probabilities[i], 1 / (1 + std::exp(-log_odds)), 1e-7) << i;
      ASSERT_EQ(evaluator.probability(scores[i]), probabilities[i]) << i;
    }
    EXPECT_EQ(probabilities.back(), 42) << "wrote behind the end";
  });
}

TEST(ConfidenceEvaluator, EqualsTreeWalk) {
  for (const int features : {1, 7, 20, ConfidenceForest::kMaxFeatures}) {
    for (const int count : {0, 1, 33, 200, kQueries}) {
      SCOPED_TRACE(testing::Message() << features << " features, " << count << " queries");
      expectTreeWalk(makeConfidenceForest(features, 24, 8, 3), count);
    }
  }
}

/// The sum of the leaves is the largest that must fit into 16 bits.
TEST(ConfidenceEvaluator, MostTreesWithTheLargestLeaves) {
  ConfidenceForest forest = makeConfidenceForest(4, ConfidenceForest::kMaxTrees, 2, 7);
  forest.leaf_unit = 1.0 / 16384;
  for (ObliviousTree& tree : forest.trees) {
    tree.levels = {{0, 128}};
    tree.leaves = {-128, 127};
  }
  expectTreeWalk(forest, kQueries);
}

TEST(ConfidenceEvaluator, ScoresRiseWithTheProbability) {
  const ConfidenceEvaluator evaluator(makeConfidenceForest(3, 2, 1, 1));
  for (std::uint16_t score = 1; score < 200; ++score) {
    EXPECT_GT(evaluator.probability(score), evaluator.probability(score - 1));
  }
}

}  // namespace
}  // namespace cbmv::test
