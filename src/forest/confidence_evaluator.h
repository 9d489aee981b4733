#pragma once

#include <cstdint>
#include <vector>

#include "forest/confidence_forest.h"
#include "forest/oblivious_evaluator.h"

namespace cbmv {

/// Feature codes of some queries, the input of ConfidenceEvaluator. One per thread.
class ConfidenceCodes {
 public:
  static constexpr int kQueries = ObliviousEvaluator::kQueries;

  ConfidenceCodes() = default;
  explicit ConfidenceCodes(const ConfidenceForest& forest) { reserve(forest); }

  /// Makes room for the features of the forest.
  void reserve(const ConfidenceForest& forest) {
    codes_.assign(forest.feature_names.size() * kQueries, 0);
  }

  /// Codes of one feature for at most kQueries queries, minus 128.
  std::int8_t* line(int feature) {
    return codes_.data() + static_cast<std::ptrdiff_t>(feature) * kQueries;
  }
  const std::int8_t* data() const { return codes_.data(); }

 private:
  std::vector<std::int8_t, CacheLineAllocator<std::int8_t>> codes_;
};

/// Applies a confidence forest to codes. Built once from a valid forest. Thread-safe: any number of
/// threads may read it.
class ConfidenceEvaluator {
 public:
  static constexpr int kQueries = ConfidenceCodes::kQueries;

  explicit ConfidenceEvaluator(const ConfidenceForest& forest);

  /// Computes the scores of the first `count` queries, at most kQueries. A higher score is a higher
  /// probability. Scores of the same forest are comparable. `scores` has room for kQueries values;
  /// those after the first `count` become unspecified.
  void score(const ConfidenceCodes& codes, int count, std::uint16_t* scores) const {
    trees_.sumLeaves(0, trees_.trees(), codes.data(), count, scores);
  }

  /// Converts a score to a probability in [0, 1].
  float probability(std::uint16_t score) const { return probability_of_score_[score]; }

  /// Converts a score to a probability in 1/255, rounded.
  std::uint8_t probabilityByte(std::uint16_t score) const { return byte_of_score_[score]; }

  /// Computes the probabilities of the first `count` queries, at most kQueries.
  void evaluate(const ConfidenceCodes& codes, int count, float* probabilities) const;

 private:
  ObliviousEvaluator trees_;
  std::vector<float> probability_of_score_;
  std::vector<std::uint8_t> byte_of_score_;
};

}  // namespace cbmv
