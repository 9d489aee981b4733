#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "cbmv_stereo/forest/forest.h"
#include "cbmv_stereo/forest/tree_walker.h"

namespace cbmv {

/// An oblivious tree as the vector code wants it: of a size that every tree has, with leaves that
/// are never negative, and with levels that compare signed bytes, the other way round.
struct PackedTree {
  int depth = 0;  ///< at least kLeastDepth
  std::array<std::uint32_t, Forest::kMaxDepth>
      lines{};  ///< where the feature's codes begin in a CodeBlock
  std::array<std::int8_t, Forest::kMaxDepth> thresholds{};  ///< minus 128
  /// Indexed by the answers to "code < threshold", level k in bit k; minus the lowest leaf.
  std::array<std::uint8_t, 1 << Forest::kMaxDepth> leaves{};

  /// A table look-up by bytes reads 2⁴ leaves at once; levels that always answer "no" fill up.
  static constexpr int kLeastDepth = 4;
};

/// Applies a forest to features: oblivious trees to codes, with the widest vectors that the
/// machine has, general trees to values. Built once from a Forest, then read by any number of
/// threads. `costs[i]` becomes the matching cost of hypothesis i: 1 − probability, times 255,
/// rounded (Batsos et al. 2018, section 3.3).
class ForestEvaluator {
 public:
  explicit ForestEvaluator(const Forest& forest);

  /// The trees are general ones: they want values, not codes.
  bool wantsValues() const { return !walker_.empty(); }

  /// Of the first `count` hypotheses of the block; for oblivious trees.
  void evaluate(const CodeBlock& codes, int count, std::uint8_t* costs) const;

  /// `values[f]` points to `count` values of feature f; for general trees.
  void evaluate(const std::array<const float*, kFeatureCount>& values, int count,
                std::uint8_t* costs) const;

 private:
  std::vector<PackedTree> trees_;
  std::vector<std::uint8_t> cost_of_sum_;  ///< indexed by the sum of the packed leaves
  TreeWalker walker_;
};

}  // namespace cbmv
