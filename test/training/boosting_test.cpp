#include "cbmv_stereo/training/boosting.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "support/checkerboard_samples.h"
#include "support/random_forest.h"

#include "cbmv_stereo/error.h"

namespace cbmv::test {
namespace {

void ignoreProgress(int /*tree*/, double /*log_loss*/) {}

TEST(Boosting, ReachesTheEntropyOfTheData) {
  BoostingOptions options;
  options.trees = 12;
  options.depth = 3;
  const Forest forest = trainForest(checkerboard(20000), options, ignoreProgress);
  const double entropy = -0.9 * std::log(0.9) - 0.1 * std::log(0.1);
  EXPECT_NEAR(forest.provenance.held_out_log_loss, entropy, 0.02);
  const auto cost = [&](float f2, float f15) {
    return naiveForestCost(forest, [&](int f) {
      const float value = f == 2 ? f2 : f == 15 ? f15 : 0.3F;
      const CodeMap& map = forest.quantizer.maps[f];
      return std::floor(map.scale * value + map.offset);
    });
  };
  EXPECT_NEAR(cost(0.7F, 0.2F) / 255.0, 0.1, 0.03);
  EXPECT_NEAR(cost(0.2F, 0.2F) / 255.0, 0.9, 0.03);
  EXPECT_NEAR(cost(0.7F, 0.8F) / 255.0, 0.9, 0.03);
}

/// With one level and the whole step, the first tree is the best question of all, and its leaves
/// are the log-odds of their samples.
TEST(Boosting, FirstTreeIsTheBestStump) {
  Samples samples = checkerboard(4000);
  for (std::size_t n = 0; n < samples.labels.size(); ++n) {
    samples.labels[n] = samples.features[6][n] > 0.25F ? 1 : 0;
  }
  BoostingOptions options;
  options.trees = 1;
  options.depth = 1;
  const Forest forest = trainForest(samples, options, ignoreProgress);
  const ObliviousTree::Level level = forest.trees[0].levels[0];
  const CodeMap& map = forest.quantizer.maps[6];
  EXPECT_EQ(level.feature, 6);
  EXPECT_NEAR((level.threshold - map.offset) / map.scale, 0.25, 2 / map.scale);
  EXPECT_LT(forest.trees[0].leaves[0], 0);
  EXPECT_GT(forest.trees[0].leaves[1], 0);
}

/// The log-loss that the training reports is that of the forest it returns, tree by tree.
TEST(Boosting, ReportsTheLogLossOfItsForest) {
  const Samples samples = checkerboard(3000);
  BoostingOptions options;
  options.trees = 7;
  const Forest forest = trainForest(samples, options, ignoreProgress);
  double loss = 0;
  int count = 0;
  for (long n = 0; n < samples.count(); n += 10, ++count) {
    const double log_odds = naiveLogOdds(forest, [&](int f) {
      const CodeMap& map = forest.quantizer.maps[f];
      return std::clamp(std::floor(map.scale * samples.features[f][n] + map.offset), 0.0F, 255.0F);
    });
    loss += std::log(1 + std::exp(samples.labels[n] == 1 ? -log_odds : log_odds));
  }
  EXPECT_NEAR(forest.provenance.held_out_log_loss, loss / count, 1e-9);
}

TEST(Boosting, HeldOutSamplesHaveNoSay) {
  Samples samples = checkerboard(3000);
  BoostingOptions options;
  options.trees = 3;
  const Forest forest = trainForest(samples, options, ignoreProgress);
  for (long n = 0; n < samples.count(); n += 10) {
    samples.labels[n] = static_cast<std::uint8_t>(1 - samples.labels[n]);
  }
  const Forest other = trainForest(samples, options, ignoreProgress);
  EXPECT_EQ(forest.bias, other.bias);
  for (std::size_t t = 0; t < forest.trees.size(); ++t) {
    EXPECT_EQ(forest.trees[t].leaves, other.trees[t].leaves);
  }
}

/// The labels hang on features 2 and 15 alone.
TEST(Boosting, NamesTheFeaturesThatMatter) {
  BoostingOptions options;
  options.trees = 8;
  options.depth = 2;
  const Forest forest = trainForest(checkerboard(20000), options, ignoreProgress);
  const std::vector<double>& importance = forest.provenance.feature_importance;
  ASSERT_EQ(importance.size(), std::size_t{kFeatureCount});
  EXPECT_NEAR(std::accumulate(importance.begin(), importance.end(), 0.0), 1, 1e-9);
  for (int f = 0; f < kFeatureCount; ++f) {
    EXPECT_EQ(importance[f] > 0.3, f == 2 || f == 15) << f << ": " << importance[f];
  }
}

TEST(Boosting, AsksForTheFeaturesOfTheGivenMatchersOnly) {
  BoostingOptions options;
  options.trees = 6;
  options.matchers = MatcherSelection().set(kNcc).set(kSobelSad);
  for (const ObliviousTree& tree : trainForest(checkerboard(3000), options, ignoreProgress).trees) {
    for (const ObliviousTree::Level& level : tree.levels) {
      EXPECT_TRUE(options.matchers[level.feature / kFeaturesPerMatcher]);
    }
  }
}

TEST(Boosting, DoesNotDependOnThreads) {
  const auto train = [](int threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                    static_cast<std::size_t>(threads));
    BoostingOptions options;
    options.trees = 5;
    return trainForest(checkerboard(5000), options, ignoreProgress);
  };
  const Forest one = train(1);
  const Forest four = train(4);
  for (std::size_t t = 0; t < one.trees.size(); ++t) {
    EXPECT_EQ(one.trees[t].leaves, four.trees[t].leaves);
  }
}

TEST(Boosting, RefusesImpossibleOptions) {
  const Samples samples = checkerboard(100);
  const auto train = [&](const auto& change) {
    BoostingOptions options;
    change(options);
    trainForest(samples, options, ignoreProgress);
  };
  EXPECT_THROW(train([](BoostingOptions& o) { o.trees = 0; }), Error);
  EXPECT_THROW(train([](BoostingOptions& o) { o.depth = 9; }), Error);
  EXPECT_THROW(train([](BoostingOptions& o) { o.learning_rate = 0; }), Error);
  EXPECT_THROW(train([](BoostingOptions& o) { o.matchers.reset(); }), Error);
  Samples one_class = samples;
  std::fill(one_class.labels.begin(), one_class.labels.end(), std::uint8_t{1});
  EXPECT_THROW(trainForest(one_class, {}, ignoreProgress), Error);
}

}  // namespace
}  // namespace cbmv::test
