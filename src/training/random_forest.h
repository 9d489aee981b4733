#pragma once

#include <cstdint>

#include "forest/forest.h"
#include "training/sampling.h"

namespace cbmv {

struct RandomForestOptions {
  int trees = 50;
  /// At least. The paper's 700 are of many more samples; of these, they make trees too small.
  int samples_per_leaf = 50;
  int features_per_split = 10;      ///< drawn anew for each node
  double samples_per_tree = 0.632;  ///< part drawn for each tree: what a bootstrap sample holds
};

/// The forest of the paper (Batsos et al. 2018, section 3.3), grown by XGBoost: each tree from its
/// own part of the samples, each split the one that lowers the Gini impurity most, among 256
/// quantiles of some features; a leaf holds the share of its samples that are correct, and the
/// forest answers with the mean over its trees. The trees are general ones.
///
/// The same forest with any number of threads. Throws Error if an option is out of range, one of
/// the classes has no samples or none is held out. The result's provenance holds samples and
/// feature_importance: the part of the impurity removed by each feature's splits.
Forest trainRandomForest(const Samples& samples, const RandomForestOptions& options,
                         std::uint64_t seed);

}  // namespace cbmv
