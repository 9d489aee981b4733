#include "forest/tree_walker.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace cbmv {
namespace {

using ValueLines = std::array<const float*, kFeatureCount>;

constexpr int kAbreast = 16;  // hypotheses that traverse a tree together

/// Adds the leaves of the hypotheses [first, first + count), at most kAbreast.
void addLeaves(const DecisionTree& tree, const ValueLines& values, int first, int count,
               float* sums) {
  const DecisionTree::Node* nodes = tree.nodes.data();
  std::array<std::uint32_t, kAbreast> places{};
  std::uint32_t moved = 1;
  while (moved != 0) {
    moved = 0;
    for (int k = 0; k < count; ++k) {
      const DecisionTree::Node& node = nodes[places[k]];
      const int answer = values[node.feature][first + k] >= node.threshold ? 1 : 0;
      moved |= places[k] ^ node.next[answer];
      places[k] = node.next[answer];
    }
  }
  for (int k = 0; k < count; ++k) {
    sums[first + k] += nodes[places[k]].threshold;
  }
}

float probabilityOf(float sum, ForestOutput output) {
  return output == ForestOutput::kLogOdds ? 1.0F / (1.0F + std::exp(-sum))
                                          : std::clamp(sum, 0.0F, 1.0F);
}

}  // namespace

void TreeWalker::evaluate(const ValueLines& values, int count, float* probabilities) const {
  std::fill_n(probabilities, count, bias_);
  for (int block = 0; block < count; block += kBlock) {
    const int end = std::min(block + kBlock, count);
    for (const DecisionTree& tree : trees_) {
      for (int first = block; first < end; first += kAbreast) {
        addLeaves(tree, values, first, std::min(kAbreast, end - first), probabilities);
      }
    }
  }
  std::transform(probabilities, probabilities + count, probabilities,
                 [this](float sum) { return probabilityOf(sum, output_); });
}

}  // namespace cbmv
