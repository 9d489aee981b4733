#pragma once

#include <cmath>
#include <cstdint>
#include <random>

#include "cbmv_stereo/forest/forest.h"

namespace cbmv::test {

/// A forest of random trees of all depths up to `max_depth`, with maps that spread typical
/// features.
inline Forest makeForest(int trees, int max_depth, std::uint32_t seed) {
  std::mt19937 random(seed);
  const auto draw = [&random](int lowest, int highest) {
    return std::uniform_int_distribution<int>(lowest, highest)(random);
  };
  Forest forest;
  forest.name = "random.forest";
  forest.bias = -0.25;
  forest.provenance.program = "test";
  forest.provenance.scenes = {"random"};
  for (int f = 0; f < kFeatureCount; ++f) {
    const bool cost = f % kFeaturesPerMatcher == kCost;
    forest.quantizer.maps[f] = {cost ? 8.0F : 20.0F, cost ? 40.0F : 250.0F};
  }
  for (int t = 0; t < trees; ++t) {
    ObliviousTree tree;
    const int depth = 1 + t % max_depth;
    for (int level = 0; level < depth; ++level) {
      tree.levels.push_back({static_cast<std::uint8_t>(draw(0, kFeatureCount - 1)),
                             static_cast<std::uint8_t>(draw(0, 255))});
    }
    for (int leaf = 0; leaf < 1 << depth; ++leaf) {
      tree.leaves.push_back(static_cast<std::int8_t>(draw(-128, 127)));
    }
    forest.trees.push_back(tree);
  }
  return forest;
}

/// Log-odds of one hypothesis, tree by tree, question by question.
template <typename CodeOf>
double naiveLogOdds(const Forest& forest, const CodeOf& code_of) {
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

template <typename CodeOf>
std::uint8_t naiveForestCost(const Forest& forest, const CodeOf& code_of) {
  const double probability = 1 / (1 + std::exp(-naiveLogOdds(forest, code_of)));
  return static_cast<std::uint8_t>(std::lround(255 * (1 - probability)));
}

}  // namespace cbmv::test
