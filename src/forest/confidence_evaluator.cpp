#include "forest/confidence_evaluator.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace cbmv {
namespace {

float probabilityOf(double log_odds) {
  return static_cast<float>(1.0 / (1.0 + std::exp(-log_odds)));
}

std::uint8_t byteOf(double log_odds) {
  return static_cast<std::uint8_t>(std::lround(255.0 / (1.0 + std::exp(-log_odds))));
}

}  // namespace

ConfidenceEvaluator::ConfidenceEvaluator(const ConfidenceForest& forest)
    : trees_(forest),
      probability_of_score_(trees_.tableOfSums(probabilityOf)),
      byte_of_score_(trees_.tableOfSums(byteOf)) {}

void ConfidenceEvaluator::evaluate(const ConfidenceCodes& codes, int count,
                                   float* probabilities) const {
  alignas(64) std::array<std::uint16_t, kQueries> scores;
  score(codes, count, scores.data());
  std::transform(scores.begin(), scores.begin() + count, probabilities,
                 [this](std::uint16_t score) { return probability(score); });
}

}  // namespace cbmv
