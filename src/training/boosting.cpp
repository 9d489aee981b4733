#include "training/boosting.h"

#include <algorithm>
#include <array>
#include <limits>
#include <string>

#include <tbb/parallel_for.h>

#include "training/booster.h"
#include "training/quantile.h"
#include "training/training_checks.h"

namespace cbmv {
namespace {

constexpr float kLowestLogLikelihood = -16.0F;

CodeMap mapBetween(float lowest, float highest) {
  const float scale = 254.0F / std::max(highest - lowest, 1e-3F);
  return {scale, 1.0F - scale * lowest};
}

/// Codes of all samples, a column per feature.
std::vector<Booster::Column> codesOf(const Samples& samples, const FeatureQuantizer& quantizer) {
  std::vector<Booster::Column> codes(kFeatureCount);
  tbb::parallel_for(0, kFeatureCount, [&](int f) {
    const std::vector<float>& values = samples.features[f];
    codes[f].resize(values.size());
    quantize(quantizer.maps[f], values.data(), static_cast<int>(values.size()), codes[f].data());
  });
  return codes;
}

/// Grows the trees, after each of which the record holds its log-loss.
void grow(Booster& booster, long samples, const BoostingOptions& options,
          const BoostingProgress& progress, ObliviousForest& forest, TrainingRecord& record) {
  forest.leaf_unit = options.leaf_unit;
  forest.bias = booster.bias();
  for (int tree = 1; tree <= options.trees; ++tree) {
    forest.trees.push_back(booster.addTree());
    record.held_out_log_loss = booster.heldOutLogLoss();
    progress(tree, record.held_out_log_loss);
  }
  record.samples = samples;
  record.feature_importance = shares(booster.gains());
}

void checkOptions(const SampleLabels& samples, const BoostingOptions& options) {
  requireForTraining(options.leaf_unit > 0 && options.regularization >= 0,
                     "leaf unit and regularization are not both positive. Correct them");
  requireBothClasses(samples);
  requireTreeCount(options.trees);
  requireForTraining(options.depth >= 1 && options.depth <= Forest::kMaxDepth,
                     "the depth must be in [1, " + std::to_string(Forest::kMaxDepth) + "]");
  requireForTraining(options.learning_rate > 0 && options.learning_rate <= 1,
                     "the learning rate must be in (0, 1]");
}

void checkColumns(const ConfidenceSamples& samples) {
  const std::size_t features = samples.features.size();
  requireForTraining(features >= 1 && features <= ConfidenceForest::kMaxFeatures &&
                         features == samples.feature_names.size(),
                     "there are " + std::to_string(features) + " columns of features and " +
                         std::to_string(samples.feature_names.size()) +
                         " names, expected as many, 1 to " +
                         std::to_string(ConfidenceForest::kMaxFeatures));
  requireForTraining(samples.held_out.size() == samples.labels.size(),
                     "there are " + std::to_string(samples.labels.size()) + " labels and " +
                         std::to_string(samples.held_out.size()) +
                         " marks of held-out samples, expected as many");
  for (std::size_t f = 0; f < features; ++f) {
    requireForTraining(samples.features[f].size() == samples.labels.size(),
                       "feature \"" + samples.feature_names[f] + "\" has " +
                           std::to_string(samples.features[f].size()) + " values, expected " +
                           std::to_string(samples.labels.size()) + ", one for each label");
  }
}

}  // namespace

FeatureQuantizer fitQuantizer(const Samples& samples) {
  FeatureQuantizer quantizer;
  tbb::parallel_for(0, kMatcherCount, [&](int m) {
    const auto between = [&](int low, int high, float floor) {
      const auto quantile_of = [&](int feature, double share) {
        std::vector<float> values = samples.features[featureIndex(m, feature)];
        return quantile(values, share);
      };
      const CodeMap map =
          mapBetween(std::max(floor, quantile_of(low, 0.005)), quantile_of(high, 0.995));
      quantizer.maps[featureIndex(m, low)] = map;
      quantizer.maps[featureIndex(m, high)] = map;
    };
    const float no_floor = -std::numeric_limits<float>::max();
    between(kCost, kCost, no_floor);
    between(kRatioLow, kRatioHigh, no_floor);
    between(kLikelihoodLow, kLikelihoodHigh, kLowestLogLikelihood);
  });
  return quantizer;
}

Forest trainForest(const Samples& samples, const BoostingOptions& options,
                   const BoostingProgress& progress) {
  checkOptions(samples, options);
  requireForTraining(options.matchers.any(),
                     "no matcher is left whose features the trees may use. Correct --matchers");
  Forest forest;
  forest.quantizer = fitQuantizer(samples);
  std::vector<bool> asked(kFeatureCount);
  for (int f = 0; f < kFeatureCount; ++f) {
    asked[f] = options.matchers[f / kFeaturesPerMatcher];
  }
  const std::vector<Booster::Column> codes = codesOf(samples, forest.quantizer);
  Booster booster(codes, asked, samples, options);
  grow(booster, samples.count(), options, progress, forest, forest.provenance);
  return forest;
}

ConfidenceForest trainConfidenceForest(const ConfidenceSamples& samples,
                                       const BoostingOptions& options,
                                       const BoostingProgress& progress) {
  checkColumns(samples);
  checkOptions(samples, options);
  requireForTraining(options.trees <= ConfidenceForest::kMaxTrees,
                     "a confidence forest has at most " +
                         std::to_string(ConfidenceForest::kMaxTrees) + " trees, not " +
                         std::to_string(options.trees));
  ConfidenceForest forest;
  forest.feature_names = samples.feature_names;
  Booster booster(samples.features, std::vector<bool>(samples.features.size(), true), samples,
                  options);
  grow(booster, samples.count(), options, progress, forest, forest.record);
  return forest;
}

}  // namespace cbmv
