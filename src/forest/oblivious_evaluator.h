#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "confidence/features.h"
#include "forest/oblivious_forest.h"

namespace cbmv {

/// An oblivious tree as the vector code wants it: of a size that every tree has, with leaves that
/// are never negative, and with levels that compare signed bytes, the other way round.
struct PackedTree {
  int depth = 0;  ///< at least kLeastDepth
  /// Where the feature's codes begin in a block of codes.
  std::array<std::uint32_t, ObliviousForest::kMaxDepth> lines{};
  std::array<std::int8_t, ObliviousForest::kMaxDepth> thresholds{};  ///< minus 128
  /// Indexed by the answers to "code < threshold", level k in bit k; minus the lowest leaf.
  std::array<std::uint8_t, 1 << ObliviousForest::kMaxDepth> leaves{};

  /// A table look-up by bytes reads 2⁴ leaves at once; levels that always answer "no" fill up.
  static constexpr int kLeastDepth = 4;
};

/// Sums of the leaves of oblivious trees over any number of features, with the widest vectors that
/// the machine has. Built once from a forest, then read by any number of threads.
class ObliviousEvaluator {
 public:
  /// So many trees have a sum of leaves that surely fits 16 bits.
  static constexpr int kTreesPerSum = 0xffff / 0xff;
  /// Queries of a block of codes.
  static constexpr int kQueries = CodeBlock::kHypotheses;

  explicit ObliviousEvaluator(const ObliviousForest& forest);

  int trees() const { return static_cast<int>(trees_.size()); }

  /// Sums of the leaves of the trees [first_tree, first_tree + tree_count), at most kTreesPerSum,
  /// each leaf minus the lowest of its tree. `codes` holds a line of kQueries codes, minus 128, per
  /// feature, in the order of the features, and begins at a cache line. `sums` has room for
  /// kQueries values, those behind the first `count` get unspecified ones.
  void sumLeaves(int first_tree, int tree_count, const std::int8_t* codes, int count,
                 std::uint16_t* sums) const;

  /// Table of `value_of(log-odds)`, indexed by the sum over all trees.
  template <typename ValueOf>
  auto tableOfSums(const ValueOf& value_of) const {
    std::vector<decltype(value_of(0.0))> table;
    for (long sum = lowest_sum_; sum <= highest_sum_; ++sum) {
      table.push_back(value_of(bias_ + leaf_unit_ * static_cast<double>(sum)));
    }
    return table;
  }

 private:
  std::vector<PackedTree> trees_;
  double bias_;
  double leaf_unit_;
  long lowest_sum_ = 0;  ///< of one leaf of each tree
  long highest_sum_ = 0;
};

}  // namespace cbmv
