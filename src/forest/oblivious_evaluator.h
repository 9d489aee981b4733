#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "confidence/features.h"
#include "forest/oblivious_forest.h"

namespace cbmv {

/// An oblivious tree in the layout for vector code: all trees have the same size, leaves are not
/// negative, and levels compare signed bytes with "<" instead of "≥".
struct PackedTree {
  int depth = 0;  ///< at least kLeastDepth
  /// Offset of the feature's codes in a block of codes.
  std::array<std::uint32_t, ObliviousForest::kMaxDepth> lines{};
  std::array<std::int8_t, ObliviousForest::kMaxDepth> thresholds{};  ///< minus 128
  /// Indexed by the results of "code < threshold", level k in bit k. The lowest leaf is subtracted.
  std::array<std::uint8_t, 1 << ObliviousForest::kMaxDepth> leaves{};

  /// A byte table look-up reads 2⁴ leaves at once. Shallower trees are extended with levels that
  /// are always false.
  static constexpr int kLeastDepth = 4;
};

/// Sums the leaves of oblivious trees over any number of features, with the widest vectors of the
/// machine. Built once from a forest. Thread-safe: any number of threads may read it.
class ObliviousEvaluator {
 public:
  /// For this many trees, the sum of the leaves fits into 16 bits.
  static constexpr int kTreesPerSum = 0xffff / 0xff;
  /// Queries per block of codes.
  static constexpr int kQueries = CodeBlock::kHypotheses;

  explicit ObliviousEvaluator(const ObliviousForest& forest);

  int trees() const { return static_cast<int>(trees_.size()); }

  /// Sums the leaves of the trees [first_tree, first_tree + tree_count), at most kTreesPerSum. The
  /// lowest leaf of each tree is subtracted. `codes` has one line of kQueries codes, minus 128, per
  /// feature, in the order of the features, and begins at a cache line. `sums` has room for
  /// kQueries values; those after the first `count` become unspecified.
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
  long lowest_sum_ = 0;  ///< of one leaf per tree
  long highest_sum_ = 0;
};

}  // namespace cbmv
