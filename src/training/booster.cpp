#include "training/booster.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <tbb/parallel_for.h>

#include "training/training_checks.h"

namespace cbmv {
namespace {

constexpr double kDerivativeUnit = 1.0 / 65536;
constexpr std::size_t kChunkSamples = 16384;

double logistic(double log_odds) { return 1.0 / (1.0 + std::exp(-log_odds)); }

double trainedLogOdds(const SampleLabels& samples) {
  std::array<double, 2> counts{};
  for (long n = 0; n < samples.count(); ++n) {
    counts[samples.labels[n]] += samples.held_out[n] == 1 ? 0 : 1;
  }
  return std::log(counts[1] / counts[0]);
}

std::int32_t toFixedPoint(double value) {
  return static_cast<std::int32_t>(std::lround(value / kDerivativeUnit));
}

}  // namespace

Booster::Booster(const std::vector<Column>& codes, std::vector<bool> asked,
                 const SampleLabels& labels, const BoostingOptions& options)
    : options_(options),
      codes_(codes),
      asked_(std::move(asked)),
      labels_(labels),
      bias_(trainedLogOdds(labels)),
      scores_(labels.labels.size(), 0),
      gains_(codes_.size(), 0.0),
      derivatives_(labels.labels.size()),
      leaf_numbers_(labels.labels.size()),
      histograms_(codes_.size()) {
  for (std::size_t begin = 0; begin < scores_.size(); begin += kChunkSamples) {
    Chunk chunk;
    chunk.begin = begin;
    chunk.end = std::min(begin + kChunkSamples, scores_.size());
    chunk.samples.resize(chunk.end - begin);
    chunk.leaves.resize(chunk.end - begin);
    chunk.derivatives.resize(chunk.end - begin);
    chunks_.push_back(std::move(chunk));
  }
  for (std::size_t f = 0; f < codes_.size(); ++f) {
    if (asked_[f]) {
      histograms_[f].resize(std::size_t{1} << (options_.depth - 1));
    }
  }
}

ObliviousTree Booster::addTree() {
  computeDerivatives();
  std::fill(leaf_numbers_.begin(), leaf_numbers_.end(), std::uint8_t{0});
  ObliviousTree tree;
  std::vector<long> leaf_sizes;
  for (int depth = 0; depth < options_.depth; ++depth) {
    select(depth, leaf_sizes);
    const Question question = bestQuestion(depth);
    gains_[question.level.feature] += question.gain;
    tree.levels.push_back(question.level);
    leaf_sizes = splitLeaves(question.level, depth);
  }
  tree.leaves = leafValues(tree.levels.back());
  tbb::parallel_for(std::size_t{0}, chunks_.size(), [&](std::size_t c) {
    for (std::size_t n = chunks_[c].begin; n < chunks_[c].end; ++n) {
      scores_[n] += tree.leaves[leaf_numbers_[n]];
    }
  });
  return tree;
}

double Booster::heldOutLogLoss() const {
  double loss = 0;
  std::size_t count = 0;
  for (std::size_t n = 0; n < scores_.size(); ++n) {
    if (labels_.held_out[n] == 1) {
      loss += logLoss(logistic(logOdds(scores_[n])), labels_.labels[n]);
      ++count;
    }
  }
  return loss / static_cast<double>(count);
}

/// Of the logistic loss. Scores are whole numbers, of which there are far fewer than samples.
void Booster::computeDerivatives() {
  const auto [lowest, highest] = std::minmax_element(scores_.begin(), scores_.end());
  std::vector<std::array<Derivatives<std::int32_t>, 2>> of_score;  // by label
  for (std::int32_t score = *lowest; score <= *highest; ++score) {
    const double probability = logistic(logOdds(score));
    const std::int32_t second = toFixedPoint(probability * (1 - probability));
    of_score.push_back(
        {{{toFixedPoint(probability), second}, {toFixedPoint(probability - 1), second}}});
  }
  tbb::parallel_for(std::size_t{0}, chunks_.size(), [&, first = *lowest](std::size_t c) {
    for (std::size_t n = chunks_[c].begin; n < chunks_[c].end; ++n) {
      derivatives_[n] = of_score[scores_[n] - first][labels_.labels[n]];
    }
  });
}

/// Of two leaves with one parent, the smaller one is summed up.
void Booster::select(int depth, const std::vector<long>& leaf_sizes) {
  summed_leaves_.assign(1, 0);
  if (depth > 0) {
    const int half = 1 << (depth - 1);
    summed_leaves_.resize(half);
    for (int leaf = 0; leaf < half; ++leaf) {
      summed_leaves_[leaf] = leaf_sizes[leaf] < leaf_sizes[leaf + half] ? leaf : leaf + half;
    }
  }
  std::vector<std::uint8_t> is_summed(std::size_t{1} << depth, 0);
  for (const int leaf : summed_leaves_) {
    is_summed[leaf] = 1;
  }
  tbb::parallel_for(std::size_t{0}, chunks_.size(),
                    [&](std::size_t c) { fillChunk(is_summed, chunks_[c]); });
}

/// Held-out samples have no say.
void Booster::fillChunk(const std::vector<std::uint8_t>& is_summed, Chunk& chunk) {
  std::size_t selected = 0;
  for (std::size_t n = chunk.begin; n < chunk.end; ++n) {
    const std::uint8_t leaf = leaf_numbers_[n];
    chunk.samples[selected] = static_cast<std::uint32_t>(n);
    chunk.leaves[selected] = leaf;
    chunk.derivatives[selected] = derivatives_[n];
    selected += static_cast<std::size_t>(is_summed[leaf] & (labels_.held_out[n] ^ 1));
  }
  chunk.selected = selected;
}

Booster::Question Booster::bestQuestion(int depth) {
  std::vector<Question> questions(codes_.size());
  tbb::parallel_for(std::size_t{0}, codes_.size(), [&](std::size_t f) {
    if (asked_[f]) {
      questions[f] = bestThreshold(static_cast<int>(f), depth);
    }
  });
  return *std::max_element(questions.begin(), questions.end(),
                           [](const Question& a, const Question& b) { return a.gain < b.gain; });
}

Booster::Question Booster::bestThreshold(int feature, int depth) {
  sumHistograms(feature, depth);
  std::array<double, kCodes> scores{};
  for (int leaf = 0; leaf < 1 << depth; ++leaf) {
    addScores(histograms_[feature][leaf], scores);
  }
  const auto best = std::max_element(scores.begin() + 1, scores.end());
  return {{static_cast<std::uint8_t>(feature), static_cast<std::uint8_t>(best - scores.begin())},
          *best - scores[0]};
}

/// From those of the level above, of which leaf k has become the leaves k and k + half.
void Booster::sumHistograms(int feature, int depth) {
  std::vector<Histogram>& histograms = histograms_[feature];
  const int half = (1 << depth) / 2;
  for (int leaf = 0; leaf < half; ++leaf) {
    if (summed_leaves_[leaf] == leaf) {
      histograms[leaf + half] = histograms[leaf];
    }
  }
  for (const int leaf : summed_leaves_) {
    histograms[leaf].fill({});
  }
  const std::uint8_t* codes = codes_[feature].data();
  for (const Chunk& chunk : chunks_) {
    for (std::size_t k = 0; k < chunk.selected; ++k) {
      Sum& bin = histograms[chunk.leaves[k]][codes[chunk.samples[k]]];
      bin.first += chunk.derivatives[k].first;
      bin.second += chunk.derivatives[k].second;
    }
  }
  for (int leaf = 0; leaf < half; ++leaf) {
    const Histogram& summed = histograms[summed_leaves_[leaf]];
    Histogram& sibling = histograms[summed_leaves_[leaf] ^ half];
    for (int code = 0; code < kCodes; ++code) {
      sibling[code].first -= summed[code].first;
      sibling[code].second -= summed[code].second;
    }
  }
}

/// What each threshold lowers the loss by within one leaf, times two, up to a constant; threshold 0
/// splits nothing.
void Booster::addScores(const Histogram& histogram, std::array<double, kCodes>& scores) const {
  Sum all;
  for (const Sum& bin : histogram) {
    all.first += bin.first;
    all.second += bin.second;
  }
  Sum below;
  for (int threshold = 0; threshold < kCodes; ++threshold) {
    scores[threshold] += score(below) + score({all.first - below.first, all.second - below.second});
    below.first += histogram[threshold].first;
    below.second += histogram[threshold].second;
  }
}

double Booster::score(const Sum& sum) const {
  if (sum.first == 0) {
    return 0;  // also without regularization
  }
  const double first = static_cast<double>(sum.first) * kDerivativeUnit;
  return first * first /
         (static_cast<double>(sum.second) * kDerivativeUnit + options_.regularization);
}

/// Returns the numbers of samples of the new leaves.
std::vector<long> Booster::splitLeaves(const ObliviousTree::Level& level, int depth) {
  const std::uint8_t* codes = codes_[level.feature].data();
  std::vector<std::array<long, 1 << ObliviousForest::kMaxDepth>> sizes(chunks_.size());
  tbb::parallel_for(std::size_t{0}, chunks_.size(), [&](std::size_t c) {
    for (std::size_t n = chunks_[c].begin; n < chunks_[c].end; ++n) {
      leaf_numbers_[n] |= static_cast<std::uint8_t>((codes[n] >= level.threshold ? 1 : 0) << depth);
      ++sizes[c][leaf_numbers_[n]];
    }
  });
  std::vector<long> leaf_sizes(std::size_t{2} << depth, 0);
  for (const auto& chunk_sizes : sizes) {
    std::transform(leaf_sizes.begin(), leaf_sizes.end(), chunk_sizes.begin(), leaf_sizes.begin(),
                   std::plus<>());
  }
  return leaf_sizes;
}

/// From the histograms of the last level's feature.
std::vector<std::int8_t> Booster::leafValues(const ObliviousTree::Level& last) const {
  const std::vector<Histogram>& histograms = histograms_[last.feature];
  const std::size_t half = histograms.size();
  std::vector<std::int8_t> values(2 * half);
  for (std::size_t leaf = 0; leaf < half; ++leaf) {
    std::array<Sum, 2> sums{};
    for (int code = 0; code < kCodes; ++code) {
      Sum& sum = sums[code >= last.threshold ? 1 : 0];
      sum.first += histograms[leaf][code].first;
      sum.second += histograms[leaf][code].second;
    }
    values[leaf] = leafValue(sums[0]);
    values[leaf + half] = leafValue(sums[1]);
  }
  return values;
}

std::int8_t Booster::leafValue(const Sum& sum) const {
  const double step = -static_cast<double>(sum.first) * kDerivativeUnit /
                      (static_cast<double>(sum.second) * kDerivativeUnit + options_.regularization);
  const double units = std::round(options_.learning_rate * step / options_.leaf_unit);
  return static_cast<std::int8_t>(std::clamp(units, -128.0, 127.0));
}

}  // namespace cbmv
