#include "training/random_forest.h"

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>
#include <vector>

#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <xgboost/c_api.h>

#include "forest/forest_file.h"
#include "forest/tree_walker.h"
#include "support/checkerboard_samples.h"
#include "support/random_forest.h"
#include "support/temporary_folder.h"

#include "cbmv_stereo/error.h"

namespace cbmv::test {
namespace {

std::vector<float> walk(const Forest& forest, const Samples& samples) {
  std::array<const float*, kFeatureCount> lines{};
  for (int f = 0; f < kFeatureCount; ++f) {
    lines[f] = samples.features[f].data();
  }
  std::vector<float> probabilities(samples.count());
  TreeWalker(forest).evaluate(lines, static_cast<int>(samples.count()), probabilities.data());
  return probabilities;
}

/// Uses one thread, because these forests are too small for more.
class RandomForest : public testing::Test {
 protected:
  const tbb::global_control one_thread_{tbb::global_control::max_allowed_parallelism, 1};
};

/// With one tree on all samples, samples with the same result belong to one leaf (or to leaves with
/// the same fraction), and the result is the fraction of correct samples.
TEST_F(RandomForest, LeavesHoldTheShareOfCorrectSamples) {
  const Samples samples = checkerboard(30000);
  RandomForestOptions options;
  options.trees = 1;
  options.samples_per_tree = 1;
  options.samples_per_leaf = 300;
  const Forest forest = trainRandomForest(samples, options, 1);
  EXPECT_GT(forest.general_trees[0].nodes.size(), 11U);
  const std::vector<float> answers = walk(forest, samples);
  std::vector<std::pair<float, int>> sorted;
  for (long n = 0; n < samples.count(); ++n) {
    if (samples.held_out[n] == 0) {
      sorted.emplace_back(answers[n], samples.labels[n]);
    }
  }
  std::sort(sorted.begin(), sorted.end());
  for (auto first = sorted.begin(); first != sorted.end();) {
    int count = 0;
    int correct = 0;
    auto next = first;
    for (; next != sorted.end() && next->first == first->first; ++next, ++count) {
      correct += next->second;
    }
    EXPECT_GE(count, options.samples_per_leaf);
    EXPECT_NEAR(first->first, static_cast<double>(correct) / count, 1e-6);
    first = next;
  }
}

TEST_F(RandomForest, LearnsTheCheckerboard) {
  RandomForestOptions options;
  options.features_per_split = 10;
  const Forest forest = trainRandomForest(checkerboard(20000), options, 1);
  EXPECT_EQ(forest.general_trees.size(), 50U);
  const auto probability = [&](double f2, double f15) {
    return naiveProbability(forest, [&](int f) { return f == 2 ? f2 : f == 15 ? f15 : 0.3; });
  };
  EXPECT_NEAR(probability(0.7, 0.2), 0.9, 0.1);
  EXPECT_NEAR(probability(0.2, 0.2), 0.1, 0.1);
  EXPECT_NEAR(probability(0.7, 0.8), 0.1, 0.1);
}

/// The labels depend only on features 2 and 15.
TEST_F(RandomForest, NamesTheFeaturesThatMatter) {
  RandomForestOptions options;
  options.trees = 10;
  const Forest forest = trainRandomForest(checkerboard(20000), options, 1);
  const std::vector<double>& importance = forest.provenance.feature_importance;
  ASSERT_EQ(importance.size(), std::size_t{kFeatureCount});
  EXPECT_NEAR(std::accumulate(importance.begin(), importance.end(), 0.0), 1, 1e-9);
  for (int f = 0; f < kFeatureCount; ++f) {
    EXPECT_EQ(importance[f] > 0.2, f == 2 || f == 15) << f << ": " << importance[f];
  }
  EXPECT_EQ(forest.provenance.samples, 20000);
}

TEST_F(RandomForest, HeldOutSamplesHaveNoSay) {
  Samples samples = checkerboard(5000);
  const std::string before = forestChecksum(trainRandomForest(samples, {}, 1));
  for (long n = 0; n < samples.count(); n += 10) {
    samples.labels[n] = static_cast<std::uint8_t>(1 - samples.labels[n]);
  }
  EXPECT_EQ(forestChecksum(trainRandomForest(samples, {}, 1)), before);
}

TEST(RandomForestThreads, DoNotChangeTheForest) {
  const Samples samples = checkerboard(20000);
  const auto train = [&](std::size_t threads, std::uint64_t seed) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    RandomForestOptions options;
    options.trees = 10;
    return forestChecksum(trainRandomForest(samples, options, seed));
  };
  EXPECT_EQ(train(1, 1), train(3, 1));
  EXPECT_NE(train(1, 1), train(1, 2));
}

TEST_F(RandomForest, RejectsImpossibleOptions) {
  const Samples samples = checkerboard(100);
  const auto train = [&](const auto& change) {
    RandomForestOptions options;
    change(options);
    trainRandomForest(samples, options, 1);
  };
  EXPECT_THROW(train([](RandomForestOptions& o) { o.trees = 0; }), Error);
  EXPECT_THROW(train([](RandomForestOptions& o) { o.samples_per_leaf = 0; }), Error);
  EXPECT_THROW(train([](RandomForestOptions& o) { o.features_per_split = 21; }), Error);
  EXPECT_THROW(train([](RandomForestOptions& o) { o.samples_per_tree = 1.5; }), Error);
  Samples one_class = samples;
  std::fill(one_class.labels.begin(), one_class.labels.end(), std::uint8_t{0});
  EXPECT_THROW(trainRandomForest(one_class, {}, 1), Error);
}

/// A model trained with the XGBoost API directly, and its predictions.
class XgboostModel {
 public:
  XgboostModel(const Samples& samples, const std::string& objective,
               const std::vector<std::pair<std::string, std::string>>& parameters, int rounds) {
    std::vector<float> rows;
    for (long n = 0; n < samples.count(); ++n) {
      for (const std::vector<float>& column : samples.features) {
        rows.push_back(column[n]);
      }
    }
    const std::vector<float> labels(samples.labels.begin(), samples.labels.end());
    EXPECT_EQ(XGDMatrixCreateFromMat(rows.data(), labels.size(), kFeatureCount,
                                     std::numeric_limits<float>::quiet_NaN(), &matrix_),
              0);
    EXPECT_EQ(XGDMatrixSetFloatInfo(matrix_, "label", labels.data(), labels.size()), 0);
    EXPECT_EQ(XGBoosterCreate(&matrix_, 1, &booster_), 0);
    XGBoosterSetParam(booster_, "objective", objective.c_str());
    XGBoosterSetParam(booster_, "nthread", "1");
    for (const auto& [name, value] : parameters) {
      XGBoosterSetParam(booster_, name.c_str(), value.c_str());
    }
    for (int round = 0; round < rounds; ++round) {
      EXPECT_EQ(XGBoosterUpdateOneIter(booster_, round, matrix_), 0);
    }
  }
  ~XgboostModel() {
    XGBoosterFree(booster_);
    XGDMatrixFree(matrix_);
  }
  XgboostModel(const XgboostModel&) = delete;
  XgboostModel& operator=(const XgboostModel&) = delete;

  void save(const std::string& path) const {
    EXPECT_EQ(XGBoosterSaveModel(booster_, path.c_str()), 0);
  }

  std::vector<float> predictions() const {
    bst_ulong count = 0;
    const float* result = nullptr;
    EXPECT_EQ(XGBoosterPredict(booster_, matrix_, 0, 0, 0, &count, &result), 0);
    return {result, result + count};
  }

 private:
  DMatrixHandle matrix_ = nullptr;
  BoosterHandle booster_ = nullptr;
};

void expectSamePredictions(const Samples& samples, const XgboostModel& model) {
  const TemporaryFolder folder;
  model.save(folder.file("model.json"));
  const Forest forest = readForest(folder.file("model.json"));
  writeForest(forest, folder.file("own.forest"));
  const std::vector<float> expected = model.predictions();
  for (const char* name : {"model.json", "own.forest"}) {
    const std::vector<float> answers = walk(readForest(folder.file(name)), samples);
    ASSERT_EQ(answers.size(), expected.size());
    for (std::size_t n = 0; n < expected.size(); ++n) {
      ASSERT_NEAR(answers[n], expected[n], 1e-5) << name << " sample " << n;
    }
  }
}

TEST(XgboostFile, RandomForestPredictsTheSame) {
  const Samples samples = checkerboard(3000);
  for (const char* objective : {"binary:logistic", "reg:squarederror"}) {
    expectSamePredictions(samples, XgboostModel(samples, objective,
                                                {{"num_parallel_tree", "20"},
                                                 {"subsample", "0.632"},
                                                 {"colsample_bynode", "0.2"},
                                                 {"learning_rate", "1"},
                                                 {"max_depth", "12"},
                                                 {"tree_method", "hist"}},
                                                1));
  }
}

TEST(XgboostFile, BoostedTreesPredictTheSame) {
  const Samples samples = checkerboard(5000);
  expectSamePredictions(
      samples, XgboostModel(samples, "binary:logistic",
                            {{"max_depth", "5"}, {"base_score", "0.3"}, {"gamma", "1"}}, 12));
}

}  // namespace
}  // namespace cbmv::test
