#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "cbmv_stereo/confidence/features.h"

namespace cbmv {

/// Samples that a forest gives about the same probability.
struct ReliabilityBin {
  double predicted = 0;  ///< mean probability
  double observed = 0;   ///< part of them that is correct
  long samples = 0;
};

/// Where a forest comes from: for people and for `info`; the method does not read it.
struct ForestProvenance {
  std::string program;              ///< name and version of the trainer
  std::string data_set;             ///< kind and name, no paths
  std::vector<std::string> scenes;  ///< the scenes that were seen in training
  std::string options;              ///< options of the training, as text
  long samples = 0;                 ///< training samples
  std::uint64_t seed = 0;
  double held_out_log_loss = 0;  ///< nats per sample, on samples that were not trained on
  /// On the same samples, in order of probability; empty: not measured.
  std::vector<ReliabilityBin> reliability;
  double calibration_error = 0;  ///< expected: mean over the samples of |predicted − observed|
  /// Of each feature, the part of what all splits gained, sum 1; empty: not measured.
  std::vector<double> feature_importance;
};

/// A tree in which all nodes of a level ask the same question: the answers, one bit a level, are
/// the number of the leaf.
struct ObliviousTree {
  struct Level {
    std::uint8_t feature = 0;    ///< in [0, kFeatureCount)
    std::uint8_t threshold = 0;  ///< the level's bit is set where code ≥ threshold
  };
  std::vector<Level> levels;        ///< level k gives bit k of the leaf's number
  std::vector<std::int8_t> leaves;  ///< 2^levels, in units of Forest::leaf_unit of log-odds
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
struct Forest {
  static constexpr int kMaxDepth = 8;  ///< of oblivious trees
  static constexpr int kMaxTrees = 1024;

  std::string name;             ///< for messages: the file's name without its folder
  FeatureQuantizer quantizer;   ///< for the oblivious trees
  double leaf_unit = 1.0 / 32;  ///< log-odds per unit of a leaf of the oblivious trees
  double bias = 0;              ///< output before any tree
  std::vector<ObliviousTree> trees;
  std::vector<DecisionTree> general_trees;       ///< empty unless `trees` is
  ForestOutput output = ForestOutput::kLogOdds;  ///< of the general trees
  ForestProvenance provenance;
};

}  // namespace cbmv
