#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "confidence/features.h"
#include "forest/confidence_forest.h"
#include "forest/oblivious_forest.h"

#include "cbmv_stereo/forest.h"

namespace cbmv {

/// Origin of a forest, for users and for `info`. The method does not use it.
struct ForestProvenance : TrainingRecord {
  std::string program;              ///< name and version of the trainer
  std::string data_set;             ///< kind and name, no paths
  std::vector<std::string> scenes;  ///< scenes of the training
  std::uint64_t seed = 0;
};

/// A binary decision tree. Each node has its own feature and threshold.
struct DecisionTree {
  struct Node {
    float threshold = 0;       ///< in units of the feature; in a leaf: the value of the leaf
    std::uint8_t feature = 0;  ///< in [0, kFeatureCount)
    /// The next node if value < threshold, and if value ≥ threshold. Both come after the node
    /// itself. The next node of a leaf is the leaf itself.
    std::array<std::uint32_t, 2> next{};
  };
  static constexpr int kMaxDepth = 128;

  std::vector<Node> nodes;  ///< root first

  bool isLeaf(std::uint32_t n) const { return nodes[n].next[0] == n; }
};

/// Meaning of the sum of bias and leaves.
enum class ForestOutput {
  kLogOdds,     ///< logarithm of probability / (1 − probability)
  kProbability  ///< probability, clamped to [0, 1]
};

/// Forest for the probability that a hypothesis is correct, from the sum over all trees. The trees
/// are either oblivious trees or decision trees. Oblivious trees use codes of features and are
/// fast; the node is designed for them. Decision trees use feature values, as random forests and
/// XGBoost do; they are slow and meant for research.
///
/// A file may also have forests that were trained on the maps of this one: a confidence forest, or
/// a confidence forest and a selection forest.
struct Forest : ObliviousForest {
  std::string name;                         ///< for messages: file name without folder
  FeatureQuantizer quantizer;               ///< for the oblivious trees
  std::vector<DecisionTree> general_trees;  ///< decision trees; empty if `trees` is not; same bias
  ForestOutput output = ForestOutput::kLogOdds;  ///< meaning of bias and decision trees
  ForestProvenance provenance;
  /// Confidence of a disparity of the final map. Null: not in the file.
  std::shared_ptr<const ConfidenceForest> confidence;
  /// Confidence of a disparity that a neighbor proposes. Null: not in the file. Always null without
  /// `confidence` and without a model of the standard deviation.
  std::shared_ptr<const ConfidenceForest> selection;
};

/// One of the additional forests of a file.
struct ConfidenceStage {
  const char* name;
  std::shared_ptr<const ConfidenceForest> Forest::*forest;
};

inline constexpr std::array<ConfidenceStage, 2> kConfidenceStages = {
    {{"confidence", &Forest::confidence}, {"selection", &Forest::selection}}};

}  // namespace cbmv
