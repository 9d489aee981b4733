#include "forest/forest_evaluator.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace cbmv {
namespace {

std::uint8_t costOfLogOdds(double log_odds) {
  return static_cast<std::uint8_t>(std::lround(255.0 / (1.0 + std::exp(log_odds))));
}

template <typename Sum>
void lookUpCosts(const std::uint8_t* cost_of_sum, const Sum* sums, int count, std::uint8_t* costs) {
  int i = 0;
  for (; i + 8 <= count; i += 8) {
    std::uint64_t eight = 0;
#pragma GCC unroll 8
    for (int k = 0; k < 8; ++k) {
      eight |= static_cast<std::uint64_t>(cost_of_sum[sums[i + k]]) << (8 * k);
    }
    std::memcpy(costs + i, &eight, 8);
  }
  for (; i < count; ++i) {
    costs[i] = cost_of_sum[sums[i]];
  }
}

}  // namespace

ForestEvaluator::ForestEvaluator(const Forest& forest)
    : trees_(forest), cost_of_sum_(trees_.tableOfSums(costOfLogOdds)), walker_(forest) {}

void ForestEvaluator::evaluate(const CodeBlock& block, int count, std::uint8_t* costs) const {
  constexpr int kTreesPerSum = ObliviousEvaluator::kTreesPerSum;
  const std::int8_t* codes = block.lines[0].data();
  alignas(64) std::array<std::uint16_t, CodeBlock::kHypotheses> sums;
  if (trees_.trees() <= kTreesPerSum) {
    trees_.sumLeaves(0, trees_.trees(), codes, count, sums.data());
    lookUpCosts(cost_of_sum_.data(), sums.data(), count, costs);
    return;
  }
  std::array<std::uint32_t, CodeBlock::kHypotheses> all_sums{};
  for (int tree = 0; tree < trees_.trees(); tree += kTreesPerSum) {
    trees_.sumLeaves(tree, std::min(kTreesPerSum, trees_.trees() - tree), codes, count,
                     sums.data());
    for (int i = 0; i < count; ++i) {
      all_sums[i] += sums[i];
    }
  }
  lookUpCosts(cost_of_sum_.data(), all_sums.data(), count, costs);
}

void ForestEvaluator::evaluate(const std::array<const float*, kFeatureCount>& values, int count,
                               std::uint8_t* costs) const {
  std::array<float, TreeWalker::kBlock> probabilities{};
  for (int first = 0; first < count; first += TreeWalker::kBlock) {
    std::array<const float*, kFeatureCount> block{};
    std::transform(values.begin(), values.end(), block.begin(),
                   [first](const float* line) { return line + first; });
    const int hypotheses = std::min(TreeWalker::kBlock, count - first);
    walker_.evaluate(block, hypotheses, probabilities.data());
    std::transform(probabilities.begin(), probabilities.begin() + hypotheses, costs + first,
                   [](float probability) {
                     return static_cast<std::uint8_t>(std::lround(255.0F * (1.0F - probability)));
                   });
  }
}

}  // namespace cbmv
