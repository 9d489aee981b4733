#include "cbmv_stereo/forest/forest_evaluator.h"

#include <algorithm>
#include <cmath>

namespace cbmv {
namespace {

constexpr int kBlock = 512;  // hypotheses whose sums and leaf numbers stay in the first-level cache

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

void ForestEvaluator::accumulate(const ObliviousTree& tree,
                                 const std::array<const std::uint8_t*, kFeatureCount>& codes,
                                 int first, int count, std::int32_t* sums) const {
  std::array<std::uint8_t, kBlock> leaf_numbers;
  std::fill_n(leaf_numbers.begin(), count, std::uint8_t{0});
  int bit = 1;
  for (const ObliviousTree::Level& level : tree.levels) {
    const std::uint8_t* code = codes[level.feature] + first;
    const std::uint8_t threshold = level.threshold;
    const auto mask = static_cast<std::uint8_t>(bit);
    for (int i = 0; i < count; ++i) {
      leaf_numbers[i] |= code[i] >= threshold ? mask : std::uint8_t{0};
    }
    bit *= 2;
  }
  for (int i = 0; i < count; ++i) {
    sums[i] += tree.leaves[leaf_numbers[i]];
  }
}

void ForestEvaluator::evaluate(const std::array<const std::uint8_t*, kFeatureCount>& codes,
                               int count, std::uint8_t* costs) const {
  std::array<std::int32_t, kBlock> sums;
  for (int first = 0; first < count; first += kBlock) {
    const int block = std::min(kBlock, count - first);
    std::fill_n(sums.begin(), block, -lowest_sum_);
    for (const ObliviousTree& tree : trees_) {
      accumulate(tree, codes, first, block, sums.data());
    }
    for (int i = 0; i < block; ++i) {
      costs[first + i] = cost_of_sum_[sums[i]];
    }
  }
}

}  // namespace cbmv
