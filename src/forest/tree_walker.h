#pragma once

#include <array>
#include <vector>

#include "forest/forest.h"

namespace cbmv {

/// Applies the general trees of a forest to rows of feature values: each hypothesis walks down each
/// tree, a few of them side by side so that their waits for memory overlap. Costs microseconds a
/// hypothesis where oblivious trees cost nanoseconds.
class TreeWalker {
 public:
  explicit TreeWalker(const Forest& forest)
      : trees_(forest.general_trees),
        bias_(static_cast<float>(forest.bias)),
        output_(forest.output) {}

  /// Hypotheses for which a tree stays in the cache.
  static constexpr int kBlock = 256;

  bool empty() const { return trees_.empty(); }

  /// `values[f]` points to `count` values of feature f, none of them NaN. `probabilities[i]`
  /// becomes the probability that hypothesis i is correct, in [0, 1].
  void evaluate(const std::array<const float*, kFeatureCount>& values, int count,
                float* probabilities) const;

 private:
  std::vector<DecisionTree> trees_;
  float bias_;
  ForestOutput output_;
};

}  // namespace cbmv
