#pragma once

#include <cmath>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "forest/forest.h"

namespace cbmv::test {

/// Random trees with depths up to `max_depth`.
inline std::vector<ObliviousTree> makeObliviousTrees(int trees, int max_depth, int features,
                                                     std::uint32_t seed) {
  std::mt19937 random(seed);
  const auto draw = [&random](int lowest, int highest) {
    return std::uniform_int_distribution<int>(lowest, highest)(random);
  };
  std::vector<ObliviousTree> made;
  for (int t = 0; t < trees; ++t) {
    ObliviousTree tree;
    const int depth = 1 + t % max_depth;
    for (int level = 0; level < depth; ++level) {
      tree.levels.push_back({static_cast<std::uint8_t>(draw(0, features - 1)),
                             static_cast<std::uint8_t>(draw(0, 255))});
    }
    for (int leaf = 0; leaf < 1 << depth; ++leaf) {
      tree.leaves.push_back(static_cast<std::int8_t>(draw(-128, 127)));
    }
    made.push_back(tree);
  }
  return made;
}

/// A forest of random trees with depths up to `max_depth`. Its quantization maps spread typical
/// features.
inline Forest makeForest(int trees, int max_depth, std::uint32_t seed) {
  Forest forest;
  forest.name = "random.forest";
  forest.bias = -0.25;
  forest.provenance.program = "test";
  forest.provenance.scenes = {"random"};
  for (int f = 0; f < kFeatureCount; ++f) {
    const bool cost = f % kFeaturesPerMatcher == kCost;
    forest.quantizer.maps[f] = {cost ? 8.0F : 20.0F, cost ? 40.0F : 250.0F};
  }
  forest.trees = makeObliviousTrees(trees, max_depth, kFeatureCount, seed);
  return forest;
}

/// A confidence forest of the same kind, with features "f0", "f1", ….
inline ConfidenceForest makeConfidenceForest(int features, int trees, int max_depth,
                                             std::uint32_t seed) {
  ConfidenceForest forest;
  forest.bias = 0.75;
  forest.leaf_unit = 1.0 / 512;
  for (int f = 0; f < features; ++f) {
    forest.feature_names.push_back("f" + std::to_string(f));
  }
  forest.trees = makeObliviousTrees(trees, max_depth, features, seed);
  forest.record.options = "trees " + std::to_string(trees);
  forest.record.samples = 1234;
  forest.record.held_out_log_loss = 0.375;
  return forest;
}

/// Adds the model of the standard deviation to the forest; its last feature becomes the roughness.
inline void addSigmaModel(ConfidenceForest& forest) {
  forest.feature_names.back() = ConfidenceForest::kRoughness;
  forest.sigma_roughness_bounds = {2, 20, 200};
  for (int k = 1; k <= 40; ++k) {
    forest.sigma_px.push_back(k / 4.0);
  }
}

/// Log-odds of one hypothesis, computed tree by tree and question by question.
template <typename CodeOf>
double naiveLogOdds(const ObliviousForest& forest, const CodeOf& code_of) {
  double log_odds = forest.bias;
  for (const ObliviousTree& tree : forest.trees) {
    int leaf = 0;
    for (std::size_t level = 0; level < tree.levels.size(); ++level) {
      if (code_of(tree.levels[level].feature) >= tree.levels[level].threshold) {
        leaf += 1 << level;
      }
    }
    log_odds += forest.leaf_unit * tree.leaves[leaf];
  }
  return log_odds;
}

/// A forest of random general trees whose thresholds are integers in [−8, 8].
inline Forest makeGeneralForest(int trees, int inner_nodes, std::uint32_t seed) {
  std::mt19937 random(seed);
  const auto draw = [&random](int lowest, int highest) {
    return std::uniform_int_distribution<int>(lowest, highest)(random);
  };
  Forest forest;
  forest.name = "random.forest";
  forest.bias = 0.25;
  for (int t = 0; t < trees; ++t) {
    DecisionTree tree;
    const auto add_leaf = [&] {
      const auto itself = static_cast<std::uint32_t>(tree.nodes.size());
      tree.nodes.push_back({static_cast<float>(draw(-100, 100)) / 256, 0, {itself, itself}});
      return itself;
    };
    add_leaf();
    for (int inner = 0; inner < inner_nodes;
         ++inner) {  // replaces a leaf by a node with two leaves
      int n = draw(0, static_cast<int>(tree.nodes.size()) - 1);
      while (!tree.isLeaf(n)) {
        n = static_cast<int>(tree.nodes[n].next[draw(0, 1)]);
      }
      const std::uint32_t low = add_leaf();
      const std::uint32_t high = add_leaf();
      tree.nodes[n] = {static_cast<float>(draw(-8, 8)),
                       static_cast<std::uint8_t>(draw(0, kFeatureCount - 1)),
                       {low, high}};
    }
    forest.general_trees.push_back(tree);
  }
  return forest;
}

/// Probability of one hypothesis from the general trees, in double precision.
template <typename ValueOf>
double naiveProbability(const Forest& forest, const ValueOf& value_of) {
  double sum = forest.bias;
  for (const DecisionTree& tree : forest.general_trees) {
    std::uint32_t n = 0;
    while (!tree.isLeaf(n)) {
      const DecisionTree::Node& node = tree.nodes[n];
      n = value_of(node.feature) < node.threshold ? node.next[0] : node.next[1];
    }
    sum += tree.nodes[n].threshold;
  }
  if (forest.output == ForestOutput::kProbability) {
    return std::fmin(1.0, std::fmax(0.0, sum));
  }
  return 1 / (1 + std::exp(-sum));
}

template <typename CodeOf>
std::uint8_t naiveForestCost(const Forest& forest, const CodeOf& code_of) {
  const double probability = 1 / (1 + std::exp(-naiveLogOdds(forest, code_of)));
  return static_cast<std::uint8_t>(std::lround(255 * (1 - probability)));
}

}  // namespace cbmv::test
