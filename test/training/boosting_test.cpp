#include "training/boosting.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "support/checkerboard_samples.h"
#include "support/error_text.h"
#include "support/random_forest.h"

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

/// With one level and learning rate 1, the first tree is the best question of all, and its leaves
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

/// The log-loss reported by the training equals that of the returned forest after each tree.
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

/// The labels depend only on features 2 and 15.
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

constexpr float kCodesPerUnit = 250;

/// The same samples for a confidence forest, limited to the first `features` columns.
ConfidenceSamples confidenceSamples(const Samples& samples, int features) {
  ConfidenceSamples chosen;
  static_cast<SampleLabels&>(chosen) = samples;
  for (int f = 0; f < features; ++f) {
    chosen.feature_names.push_back("f" + std::to_string(f));
    chosen.features.emplace_back();
    for (const float value : samples.features[f]) {
      chosen.features.back().push_back(static_cast<std::uint8_t>(kCodesPerUnit * value));
    }
  }
  return chosen;
}

/// The labels depend on all features, for different numbers of features.
TEST(Boosting, TrainsConfidenceForests) {
  BoostingOptions options;
  options.trees = 12;
  options.depth = 3;
  options.matchers.reset();  // has no effect on confidence forests
  const ConfidenceForest forest =
      trainConfidenceForest(confidenceSamples(checkerboard(20000), 16), options, ignoreProgress);
  EXPECT_EQ(forest.feature_names.at(15), "f15");
  EXPECT_EQ(forest.leaf_unit, options.leaf_unit);
  EXPECT_EQ(forest.record.samples, 20000);
  const double entropy = -0.9 * std::log(0.9) - 0.1 * std::log(0.1);
  EXPECT_NEAR(forest.record.held_out_log_loss, entropy, 0.02);
  ASSERT_EQ(forest.record.feature_importance.size(), 16U);
  EXPECT_GT(forest.record.feature_importance[2], 0.3);
  EXPECT_GT(forest.record.feature_importance[15], 0.3);
  const auto probability = [&](float f2, float f15) {
    const double log_odds = naiveLogOdds(forest, [&](int f) {
      return kCodesPerUnit * (f == 2 ? f2 : f == 15 ? f15 : 0.3F);
    });
    return 1 / (1 + std::exp(-log_odds));
  };
  EXPECT_NEAR(probability(0.7F, 0.2F), 0.9, 0.03);
  EXPECT_NEAR(probability(0.2F, 0.2F), 0.1, 0.03);
}

TEST(Boosting, NamesWhatIsWrongWithSamplesOfConfidence) {
  const auto fault = [](const auto& change) {
    ConfidenceSamples samples = confidenceSamples(checkerboard(100), 3);
    BoostingOptions options;
    change(samples, options);
    return errorText([&] { trainConfidenceForest(samples, options, ignoreProgress); });
  };
  using Changed = ConfidenceSamples;
  EXPECT_TRUE(mentions(fault([](Changed& s, auto&) { s.feature_names.pop_back(); }),
                       {"3 columns", "2 names"}));
  EXPECT_TRUE(mentions(fault([](Changed& s, auto&) {
                         s.features.resize(65, s.features[0]);
                         s.feature_names.resize(65);
                       }),
                       {"65 columns", "1 to 64"}));
  EXPECT_TRUE(mentions(fault([](Changed& s, auto&) { s.held_out.pop_back(); }),
                       {"100 labels", "99 marks"}));
  EXPECT_TRUE(mentions(fault([](Changed& s, auto&) { s.features[1].pop_back(); }),
                       {"\"f1\" has 99 values", "100"}));
  EXPECT_TRUE(mentions(fault([](Changed&, auto& o) { o.trees = 257; }), {"256 trees", "257"}));
  EXPECT_TRUE(mentions(fault([](Changed&, auto& o) { o.depth = 9; }), {"depth"}));
}

TEST(Boosting, RejectsImpossibleOptions) {
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
