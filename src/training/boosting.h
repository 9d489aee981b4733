#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "forest/forest.h"
#include "training/confidence_samples.h"
#include "training/sampling.h"

namespace cbmv {

/// Feature maps that spread the samples over the 256 codes: linear between the 0.5 % and the 99.5 %
/// quantile; logarithms of likelihoods below −16 (probability 1e-7) share the lowest code.
FeatureQuantizer fitQuantizer(const Samples& samples);

struct BoostingOptions {
  int trees = 64;
  int depth = 6;                  ///< levels a tree, at most Forest::kMaxDepth
  double learning_rate = 0.3;     ///< part of the optimal step that each tree takes
  double regularization = 10.0;   ///< added to a leaf's second derivative
  double leaf_unit = 1.0 / 64.0;  ///< log-odds per unit of a leaf; leaves have 8 bits
  /// Whose features trees may ask for; a forest of fewer matchers is faster. Says nothing about
  /// confidence forests.
  MatcherSelection matchers = allMatchers();
};

/// Called after each tree: trees done, log-loss on the held-out samples (nats a sample).
using BoostingProgress = std::function<void(int, double)>;

/// Gradient boosting of oblivious trees for logistic loss (Friedman 2001, with second derivatives):
/// each level asks the question that lowers the loss most, summed over all leaves. Leaves are
/// rounded to `leaf_unit` at once, so that later trees correct the rounding of earlier ones. Sums
/// are of integers: the same forest with any number of threads.
///
/// Throws Error if an option is out of range, one of the classes has no samples to train on, or no
/// sample is held out. The result's provenance holds samples, held_out_log_loss and
/// feature_importance: the part of the score gained by each feature's questions.
Forest trainForest(const Samples& samples, const BoostingOptions& options,
                   const BoostingProgress& progress);

/// The same for a confidence forest, which may ask for all of its features. The result's record
/// holds samples, held_out_log_loss and feature_importance. Throws Error also if columns and names
/// do not fit each other or ConfidenceForest::kMaxFeatures.
ConfidenceForest trainConfidenceForest(const ConfidenceSamples& samples,
                                       const BoostingOptions& options,
                                       const BoostingProgress& progress);

}  // namespace cbmv
