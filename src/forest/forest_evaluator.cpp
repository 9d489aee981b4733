#include "cbmv_stereo/forest/forest_evaluator.h"

#include <algorithm>
#include <cmath>

namespace cbmv {
namespace {

/// Hypotheses that are evaluated together. Their codes are copied into an array of this size, so
/// that all loops have a constant length and vectorise.
constexpr int kBlock = 64;
using Block = std::array<std::uint8_t, kBlock>;
using CodeBlock = std::array<Block, kFeatureCount>;

/// Sets `bit` of each number where the code reaches the threshold. Kept out of line: gcc 12 merges
/// the loops of two levels otherwise, and then vectorises neither.
[[gnu::noinline]] void answerQuestion(const Block& code, std::uint8_t threshold, std::uint8_t bit,
                                      Block& numbers) {
  for (int i = 0; i < kBlock; ++i) {
    numbers[i] = static_cast<std::uint8_t>(numbers[i] | (code[i] >= threshold ? bit : 0));
  }
}

/// Number of the leaf that each hypothesis falls into.
Block leafNumbers(const ObliviousTree& tree, const CodeBlock& codes) {
  Block numbers{};
  std::uint8_t bit = 1;
  for (const ObliviousTree::Level& level : tree.levels) {
    answerQuestion(codes[level.feature], level.threshold, bit, numbers);
    bit = static_cast<std::uint8_t>(2 * bit);
  }
  return numbers;
}

std::uint8_t costOfLogOdds(double log_odds) {
  return static_cast<std::uint8_t>(std::lround(255.0 / (1.0 + std::exp(log_odds))));
}

}  // namespace

ForestEvaluator::ForestEvaluator(const Forest& forest) : trees_(forest.trees) {
  std::int32_t highest_sum = 0;
  for (const ObliviousTree& tree : trees_) {
    const auto [lowest, highest] = std::minmax_element(tree.leaves.begin(), tree.leaves.end());
    lowest_sum_ += *lowest;
    highest_sum += *highest;
  }
  for (std::int32_t sum = lowest_sum_; sum <= highest_sum; ++sum) {
    cost_of_sum_.push_back(costOfLogOdds(forest.bias + forest.leaf_unit * sum));
  }
}

void ForestEvaluator::evaluate(const std::array<const std::uint8_t*, kFeatureCount>& codes,
                               int count, std::uint8_t* costs) const {
  CodeBlock code_block{};
  std::array<std::int32_t, kBlock> sums;
  for (int first = 0; first < count; first += kBlock) {
    const int block = std::min(kBlock, count - first);
    for (int f = 0; f < kFeatureCount; ++f) {
      std::copy_n(codes[f] + first, block, code_block[f].begin());
    }
    sums.fill(-lowest_sum_);
    for (const ObliviousTree& tree : trees_) {
      const Block numbers = leafNumbers(tree, code_block);
      for (int i = 0; i < kBlock; ++i) {
        sums[i] += tree.leaves[numbers[i]];
      }
    }
    for (int i = 0; i < block; ++i) {
      costs[first + i] = cost_of_sum_[sums[i]];
    }
  }
}

}  // namespace cbmv
