#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "forest/forest.h"
#include "forest/oblivious_evaluator.h"
#include "forest/tree_walker.h"

namespace cbmv {

/// Applies a forest to features: oblivious trees to codes, with the widest vectors of the machine;
/// decision trees to values. `costs[i]` is the matching cost of hypothesis i: 1 − probability,
/// times 255, rounded (Batsos et al. 2018, section 3.3). Built once from a Forest. Thread-safe: any
/// number of threads may read it.
class ForestEvaluator {
 public:
  explicit ForestEvaluator(const Forest& forest);

  /// Returns true for decision trees, which use values instead of codes.
  bool wantsValues() const { return !walker_.empty(); }

  /// Evaluates the first `count` hypotheses of the block. For oblivious trees.
  void evaluate(const CodeBlock& codes, int count, std::uint8_t* costs) const;

  /// Evaluates `count` hypotheses. `values[f]` points to the `count` values of feature f. For
  /// decision trees.
  void evaluate(const std::array<const float*, kFeatureCount>& values, int count,
                std::uint8_t* costs) const;

 private:
  ObliviousEvaluator trees_;
  std::vector<std::uint8_t> cost_of_sum_;  ///< indexed by the sum over all oblivious trees
  TreeWalker walker_;
};

}  // namespace cbmv
