#pragma once

#include <cstdint>
#include <vector>

namespace cbmv {

/// A tree in which all nodes of a level ask the same question: the answers, one bit a level, are
/// the number of the leaf.
struct ObliviousTree {
  struct Level {
    std::uint8_t feature = 0;    ///< below the number of features of the forest
    std::uint8_t threshold = 0;  ///< the level's bit is set where code ≥ threshold
  };
  std::vector<Level> levels;        ///< level k gives bit k of the leaf's number
  std::vector<std::int8_t> leaves;  ///< 2^levels, in units of ObliviousForest::leaf_unit
};

/// What all forests of oblivious trees have in common, whatever their features. The log-odds of an
/// answer are bias + leaf_unit · Σ leaves; trees ask for codes 0 … 255 of the features.
struct ObliviousForest {
  static constexpr int kMaxDepth = 8;
  static constexpr int kMaxTrees = 1024;

  double leaf_unit = 1.0 / 32;  ///< log-odds per unit of a leaf
  double bias = 0;              ///< log-odds before any tree
  std::vector<ObliviousTree> trees;
};

}  // namespace cbmv
