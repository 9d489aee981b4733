#include "training/held_out_measures.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/checkerboard_samples.h"
#include "support/error_text.h"
#include "support/random_forest.h"

namespace cbmv::test {
namespace {

using testing::HasSubstr;

std::vector<double> naiveProbabilities(const Forest& forest, const Samples& samples) {
  std::vector<double> probabilities;
  for (long n = 0; n < samples.count(); ++n) {
    if (samples.held_out[n] == 0) {
      continue;
    }
    const auto value = [&](int f) { return samples.features[f][n]; };
    const auto code = [&](int f) {
      const CodeMap& map = forest.quantizer.maps[f];
      return std::clamp(std::floor(map.scale * value(f) + map.offset), 0.0F, 255.0F);
    };
    probabilities.push_back(forest.trees.empty() ? naiveProbability(forest, value)
                                                 : 1 / (1 + std::exp(-naiveLogOdds(forest, code))));
  }
  return probabilities;
}

TEST(HeldOutMeasures, ProbabilitiesAreThoseOfTheForest) {
  const Samples samples = checkerboard(2000);
  Forest oblivious = makeForest(12, 8, 1);
  for (CodeMap& map : oblivious.quantizer.maps) {
    map = {250, 2};
  }
  const Forest general = makeGeneralForest(9, 60, 3);
  for (const Forest& forest : {oblivious, general}) {
    const std::vector<double> expected = naiveProbabilities(forest, samples);
    const std::vector<double> found = heldOutProbabilities(forest, samples);
    ASSERT_EQ(found.size(), 200U);
    for (std::size_t n = 0; n < found.size(); ++n) {
      ASSERT_NEAR(found[n], expected[n], 1e-6) << n;
    }
  }
}

/// A stump that returns 0.25 or 0.75 depending on feature 0.
Forest stump() {
  Forest forest;
  forest.output = ForestOutput::kProbability;
  DecisionTree tree;
  tree.nodes = {{0.5F, 0, {1, 2}}, {0.25F, 0, {1, 1}}, {0.75F, 0, {2, 2}}};
  forest.general_trees = {tree};
  return forest;
}

/// `held_out` labels for both values, and unrelated samples for training.
Samples samplesOf(const std::vector<int>& low, const std::vector<int>& high) {
  Samples samples;
  const auto add = [&](float value, int label, int held_out) {
    for (std::vector<float>& column : samples.features) {
      column.push_back(value);
    }
    samples.labels.push_back(static_cast<std::uint8_t>(label));
    samples.held_out.push_back(static_cast<std::uint8_t>(held_out));
  };
  for (const int label : low) {
    add(0.1F, label, 1);
    add(0.1F, 1, 0);
  }
  for (const int label : high) {
    add(0.9F, label, 1);
    add(0.9F, 0, 0);
  }
  return samples;
}

TEST(HeldOutMeasures, CountsWhatIsCorrectInEachBin) {
  Forest forest = stump();
  measureHeldOut(samplesOf({0, 1, 0, 0, 1}, {1, 1, 0}), forest);
  const ForestProvenance& provenance = forest.provenance;
  ASSERT_EQ(provenance.reliability.size(), 2U);
  EXPECT_NEAR(provenance.reliability[0].predicted, 0.25, 1e-12);
  EXPECT_NEAR(provenance.reliability[0].observed, 0.4, 1e-12);
  EXPECT_EQ(provenance.reliability[0].samples, 5);
  EXPECT_NEAR(provenance.reliability[1].predicted, 0.75, 1e-12);
  EXPECT_NEAR(provenance.reliability[1].observed, 2.0 / 3, 1e-12);
  EXPECT_EQ(provenance.reliability[1].samples, 3);
  EXPECT_NEAR(provenance.calibration_error, (5 * 0.15 + 3 * (0.75 - 2.0 / 3)) / 8, 1e-12);
  EXPECT_NEAR(provenance.held_out_log_loss, -(5 * std::log(0.75) + 3 * std::log(0.25)) / 8, 1e-9);
}

/// Two codes with different results.
ConfidenceForest confidenceStump() {
  ConfidenceForest forest = makeConfidenceForest(1, 1, 1, 1);
  forest.bias = 0;
  forest.leaf_unit = std::log(3.0);
  forest.trees[0] = {{{0, 50}}, {-1, 1}};  // 0.25 or 0.75
  return forest;
}

TEST(HeldOutMeasures, AreTheSameOfAConfidenceForest) {
  const Samples samples = samplesOf({0, 1, 0, 0, 1}, {1, 1, 0});
  ConfidenceSamples same;
  static_cast<SampleLabels&>(same) = samples;
  same.feature_names = {"f0"};
  same.features.resize(1);
  for (const float value : samples.features[0]) {
    same.features[0].push_back(static_cast<std::uint8_t>(100 * value));
  }
  ConfidenceForest confidence = confidenceStump();
  EXPECT_NEAR(heldOutProbabilities(confidence, same).at(0), 0.25, 1e-12);
  measureHeldOut(same, confidence);
  Forest forest = stump();
  measureHeldOut(samples, forest);
  EXPECT_NEAR(confidence.record.held_out_log_loss, forest.provenance.held_out_log_loss, 1e-12);
  EXPECT_NEAR(confidence.record.calibration_error, forest.provenance.calibration_error, 1e-12);
  ASSERT_EQ(confidence.record.reliability.size(), 2U);
  EXPECT_EQ(confidence.record.reliability[1].samples, 3);
}

TEST(HeldOutMeasures, ProbabilitiesAreThoseOfTheConfidenceForest) {
  const ConfidenceForest forest = makeConfidenceForest(30, 20, 8, 5);
  std::mt19937 random(9);
  ConfidenceSamples samples;
  samples.features.resize(30);
  for (int n = 0; n < 500; ++n) {
    for (std::vector<std::uint8_t>& column : samples.features) {
      column.push_back(static_cast<std::uint8_t>(random() % 256));
    }
    samples.labels.push_back(0);
    samples.held_out.push_back(n % 4 == 0 ? 1 : 0);
  }
  const std::vector<double> found = heldOutProbabilities(forest, samples);
  ASSERT_EQ(found.size(), 125U);
  for (std::size_t k = 0; k < found.size(); ++k) {
    const double log_odds = naiveLogOdds(forest, [&](int f) { return samples.features[f][4 * k]; });
    ASSERT_NEAR(found[k], 1 / (1 + std::exp(-log_odds)), 1e-12) << k;
  }
}

TEST(HeldOutMeasures, NeedHeldOutSamples) {
  Forest forest = stump();
  Samples samples = samplesOf({0, 1}, {1});
  std::fill(samples.held_out.begin(), samples.held_out.end(), std::uint8_t{0});
  EXPECT_TRUE(mentions(errorText([&] { measureHeldOut(samples, forest); }), {"held out"}));
}

TEST(HeldOutMeasures, AreDescribedWithTheFeaturesByImportance) {
  Forest forest;
  ForestProvenance& provenance = forest.provenance;
  provenance.program = "cbmv_train 1";
  provenance.scenes = {"Teddy"};
  provenance.seed = 5;
  provenance.reliability = {{0.125, 0.25, 77}};
  provenance.feature_importance.assign(kFeatureCount, 0);
  provenance.feature_importance[7] = 0.75;
  provenance.feature_importance[3] = 0.25;
  const std::string text = describeProvenance(forest);
  for (const char* part : {"cbmv_train 1", "Teddy", "seed 5", "0.1250   0.2500       77"}) {
    EXPECT_THAT(text, HasSubstr(part));
  }
  EXPECT_LT(text.find("ncc_log_ratio_high "), text.find("census_log_likelihood_low "));
  EXPECT_LT(text.find("census_log_likelihood_low "), text.find("census_cost "));
  EXPECT_THAT(text, HasSubstr("75.00 %"));
  EXPECT_THAT(text, HasSubstr("sobel_sad_log_likelihood_high "));
  EXPECT_EQ(text.find("confidence forest"), std::string::npos);
}

TEST(HeldOutMeasures, AreDescribedOfAllForestsOfAFile) {
  ConfidenceForest confidence = confidenceStump();
  confidence.record.feature_importance = {1.0};
  Forest forest;
  forest.confidence = std::make_shared<const ConfidenceForest>(confidence);
  std::string text = describeProvenance(forest);
  for (const char* part :
       {"confidence forest: 1 trees, trees 1", "1234 samples", "f0 ", "100.00 %"}) {
    EXPECT_THAT(text, HasSubstr(part));
  }
  EXPECT_EQ(text.find("selection forest"), std::string::npos);
  ConfidenceForest selection = makeConfidenceForest(2, 5, 1, 1);
  selection.record.samples = 777;
  forest.selection = std::make_shared<const ConfidenceForest>(selection);
  text = describeProvenance(forest);
  for (const char* part : {"1234 samples", "selection forest: 5 trees, trees 5\n777 samples"}) {
    EXPECT_THAT(text, HasSubstr(part));
  }
}

}  // namespace
}  // namespace cbmv::test
