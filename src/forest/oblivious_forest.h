#pragma once

#include <cstdint>
#include <vector>

namespace cbmv {

/// An oblivious tree: all nodes of a level have the same feature and threshold. The results, one
/// bit per level, are the index of the leaf.
struct ObliviousTree {
  struct Level {
    std::uint8_t feature = 0;    ///< smaller than the number of features of the forest
    std::uint8_t threshold = 0;  ///< bit of the level: code ≥ threshold
  };
  std::vector<Level> levels;        ///< level k gives bit k of the index of the leaf
  std::vector<std::int8_t> leaves;  ///< 2^levels, in units of ObliviousForest::leaf_unit
};

/// Common part of all forests of oblivious trees with any features. The log-odds of a result are
/// bias + leaf_unit · Σ leaves. Trees use feature codes 0 … 255.
struct ObliviousForest {
  static constexpr int kMaxDepth = 8;
  static constexpr int kMaxTrees = 1024;

  double leaf_unit = 1.0 / 32;  ///< log-odds per unit of a leaf
  double bias = 0;              ///< log-odds without trees
  std::vector<ObliviousTree> trees;
};

}  // namespace cbmv
