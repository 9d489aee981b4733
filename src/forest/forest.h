#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "confidence/features.h"
#include "forest/confidence_forest.h"
#include "forest/oblivious_forest.h"
#include "forest/training_record.h"

#include "cbmv_stereo/forest.h"

namespace cbmv {

/// Where a forest comes from: for people and for `info`; the method does not read it.
struct ForestProvenance : TrainingRecord {
  std::string program;              ///< name and version of the trainer
  std::string data_set;             ///< kind and name, no paths
  std::vector<std::string> scenes;  ///< the scenes that were seen in training
  std::uint64_t seed = 0;
};

/// A binary tree in which each node asks its own question about the value of a feature.
struct DecisionTree {
  struct Node {
    float threshold = 0;       ///< in units of the feature; of a leaf: what it adds to the sum
    std::uint8_t feature = 0;  ///< in [0, kFeatureCount)
    /// The node to go on with: where value < threshold, and where value ≥ threshold. Both lie
    /// behind the node itself; a leaf goes on with itself.
    std::array<std::uint32_t, 2> next{};
  };
  static constexpr int kMaxDepth = 128;

  std::vector<Node> nodes;  ///< the root first

  bool isLeaf(std::uint32_t n) const { return nodes[n].next[0] == n; }
};

/// What the bias and the leaves of a forest add up to.
enum class ForestOutput {
  kLogOdds,     ///< logarithm of probability / (1 − probability)
  kProbability  ///< the probability itself, cut to [0, 1]
};

/// Probability that a hypothesis is correct, from the sum over all trees. The trees are either
/// oblivious (codes of features, fast: what the node is made for) or general (feature values, as
/// random forests and XGBoost have them, slow: for research).
///
/// A file may also hold forests that were trained on the maps of this one: a confidence forest, or
/// a confidence forest and a selection forest.
struct Forest : ObliviousForest {
  std::string name;                         ///< for messages: the file's name without its folder
  FeatureQuantizer quantizer;               ///< for the oblivious trees
  std::vector<DecisionTree> general_trees;  ///< empty unless `trees` is; they share the bias
  ForestOutput output = ForestOutput::kLogOdds;  ///< of bias and general trees
  ForestProvenance provenance;
  /// Of a disparity of the final map. Null: the file has none.
  std::shared_ptr<const ConfidenceForest> confidence;
  /// Of a disparity that a neighbor proposes. Null: the file has none; always null without
  /// `confidence`, and without a model of the standard deviation.
  std::shared_ptr<const ConfidenceForest> selection;
};

/// One of the further forests of a file.
struct ConfidenceStage {
  const char* name;
  std::shared_ptr<const ConfidenceForest> Forest::*forest;
};

inline constexpr std::array<ConfidenceStage, 2> kConfidenceStages = {
    {{"confidence", &Forest::confidence}, {"selection", &Forest::selection}}};

}  // namespace cbmv
