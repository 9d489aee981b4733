#pragma once

#include <array>
#include <vector>

#include "forest/forest.h"

namespace cbmv {

/// Applies decision trees to rows of feature values. Several hypotheses traverse a tree together,
/// so that their memory latencies overlap. Takes microseconds per hypothesis; oblivious trees take
/// nanoseconds.
class TreeWalker {
 public:
  explicit TreeWalker(const Forest& forest)
      : trees_(forest.general_trees),
        bias_(static_cast<float>(forest.bias)),
        output_(forest.output) {}

  /// Block size in hypotheses: a tree stays in the cache for a block.
  static constexpr int kBlock = 256;

  bool empty() const { return trees_.empty(); }

  /// `values[f]` points to `count` values of feature f; NaN is not allowed. `probabilities[i]` is
  /// the probability in [0, 1] that hypothesis i is correct.
  void evaluate(const std::array<const float*, kFeatureCount>& values, int count,
                float* probabilities) const;

 private:
  std::vector<DecisionTree> trees_;
  float bias_;
  ForestOutput output_;
};

}  // namespace cbmv
