#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "forest/forest.h"
#include "forest/oblivious_evaluator.h"
#include "forest/tree_walker.h"

namespace cbmv {

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
  ObliviousEvaluator trees_;
  std::vector<std::uint8_t> cost_of_sum_;  ///< indexed by the sum over all oblivious trees
  TreeWalker walker_;
};

}  // namespace cbmv
