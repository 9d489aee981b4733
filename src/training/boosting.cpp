#include "cbmv_stereo/training/boosting.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>

#include <tbb/parallel_for.h>

#include "training_checks.h"

namespace cbmv {
namespace {

constexpr int kCodes = 256;
constexpr double kDerivativeUnit = 1.0 / 65536;  // of first and second derivatives of the loss
constexpr float kLowestLogLikelihood = -16.0F;

float quantile(std::vector<float> values, double fraction) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(
                                           fraction * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

CodeMap mapBetween(float lowest, float highest) {
  const float scale = 254.0F / std::max(highest - lowest, 1e-3F);
  return {scale, 1.0F - scale * lowest};
}

double logistic(double log_odds) { return 1.0 / (1.0 + std::exp(-log_odds)); }

struct Derivatives {
  std::int64_t first = 0;
  std::int64_t second = 0;
};

struct Question {
  ObliviousTree::Level level;
  double gain = -1;  ///< what it lowers the loss by, times two
};

/// State of a training: codes and current log-odds of every sample.
class Booster {
 public:
  Booster(const Samples& samples, const BoostingOptions& options, const FeatureQuantizer& quantizer)
      : options_(options),
        labels_(samples.labels),
        held_out_(samples.held_out),
        scores_(samples.labels.size(), 0) {
    tbb::parallel_for(0, kFeatureCount, [&](int f) {
      codes_[f].resize(labels_.size());
      quantize(quantizer.maps[f], samples.features[f].data(), static_cast<int>(labels_.size()),
               codes_[f].data());
    });
    bias_ = trainedLogOdds();
    first_.resize(labels_.size());
    second_.resize(labels_.size());
    leaf_numbers_.resize(labels_.size());
  }

  double bias() const { return bias_; }
  /// Of the questions of all trees, by feature.
  const std::array<double, kFeatureCount>& gains() const { return gains_; }

  ObliviousTree addTree() {
    computeDerivatives();
    std::fill(leaf_numbers_.begin(), leaf_numbers_.end(), std::uint8_t{0});
    ObliviousTree tree;
    for (int depth = 0; depth < options_.depth; ++depth) {
      const Question question = bestQuestion(1 << depth);
      gains_[question.level.feature] += question.gain;
      tree.levels.push_back(question.level);
      splitLeaves(question.level, depth);
    }
    tree.leaves = leafValues(1 << options_.depth);
    for (std::size_t n = 0; n < scores_.size(); ++n) {
      scores_[n] += tree.leaves[leaf_numbers_[n]];
    }
    return tree;
  }

  double heldOutLogLoss() const {
    double loss = 0;
    std::size_t count = 0;
    for (std::size_t n = 0; n < labels_.size(); ++n) {
      if (heldOut(n)) {
        loss += logLoss(logistic(bias_ + options_.leaf_unit * scores_[n]), labels_[n]);
        ++count;
      }
    }
    return loss / static_cast<double>(count);
  }

 private:
  bool heldOut(std::size_t n) const { return held_out_[n] == 1; }

  /// Log-odds of the samples that are trained on.
  double trainedLogOdds() const {
    std::array<double, 2> counts{};
    for (std::size_t n = 0; n < labels_.size(); ++n) {
      counts[labels_[n]] += heldOut(n) ? 0 : 1;
    }
    return std::log(counts[1] / counts[0]);
  }

  /// Of the logistic loss by the log-odds; zero for held-out samples, which so have no say.
  void computeDerivatives() {
    tbb::parallel_for(std::size_t{0}, labels_.size(), [&](std::size_t n) {
      const double probability = logistic(bias_ + options_.leaf_unit * scores_[n]);
      const double say = heldOut(n) ? 0 : 1 / kDerivativeUnit;
      first_[n] = static_cast<std::int32_t>(std::lround((probability - labels_[n]) * say));
      second_[n] = static_cast<std::int32_t>(std::lround(probability * (1 - probability) * say));
    });
  }

  Question bestThreshold(int feature, int leaves) const {
    std::vector<std::array<Derivatives, kCodes>> histogram(leaves);
    const std::vector<std::uint8_t>& codes = codes_[feature];
    for (std::size_t n = 0; n < codes.size(); ++n) {
      Derivatives& bin = histogram[leaf_numbers_[n]][codes[n]];
      bin.first += first_[n];
      bin.second += second_[n];
    }
    std::array<double, kCodes> scores{};
    for (const auto& bins : histogram) {
      addScores(bins, scores);
    }
    const auto best = std::max_element(scores.begin() + 1, scores.end());
    return {{static_cast<std::uint8_t>(feature), static_cast<std::uint8_t>(best - scores.begin())},
            *best - scores[0]};
  }

  /// What each threshold lowers the loss by within one leaf, times two, up to a constant; threshold
  /// 0 splits nothing.
  void addScores(const std::array<Derivatives, kCodes>& bins,
                 std::array<double, kCodes>& scores) const {
    Derivatives all;
    for (const Derivatives& bin : bins) {
      all.first += bin.first;
      all.second += bin.second;
    }
    Derivatives below;
    for (int threshold = 0; threshold < kCodes; ++threshold) {
      scores[threshold] +=
          score(below) + score({all.first - below.first, all.second - below.second});
      below.first += bins[threshold].first;
      below.second += bins[threshold].second;
    }
  }

  double score(const Derivatives& sum) const {
    if (sum.first == 0) {
      return 0;  // also without regularization
    }
    const double first = static_cast<double>(sum.first) * kDerivativeUnit;
    return first * first /
           (static_cast<double>(sum.second) * kDerivativeUnit + options_.regularization);
  }

  Question bestQuestion(int leaves) const {
    std::array<Question, kFeatureCount> questions;
    tbb::parallel_for(0, kFeatureCount, [&](int f) {
      if (options_.matchers[f / kFeaturesPerMatcher]) {
        questions[f] = bestThreshold(f, leaves);
      }
    });
    return *std::max_element(questions.begin(), questions.end(),
                             [](const Question& a, const Question& b) { return a.gain < b.gain; });
  }

  void splitLeaves(const ObliviousTree::Level& level, int depth) {
    const std::vector<std::uint8_t>& codes = codes_[level.feature];
    for (std::size_t n = 0; n < codes.size(); ++n) {
      leaf_numbers_[n] |= static_cast<std::uint8_t>((codes[n] >= level.threshold ? 1 : 0) << depth);
    }
  }

  std::vector<std::int8_t> leafValues(int leaves) const {
    std::vector<Derivatives> sums(leaves);
    for (std::size_t n = 0; n < labels_.size(); ++n) {
      sums[leaf_numbers_[n]].first += first_[n];
      sums[leaf_numbers_[n]].second += second_[n];
    }
    std::vector<std::int8_t> values;
    for (const Derivatives& sum : sums) {
      const double step =
          -static_cast<double>(sum.first) * kDerivativeUnit /
          (static_cast<double>(sum.second) * kDerivativeUnit + options_.regularization);
      const double units = std::round(options_.learning_rate * step / options_.leaf_unit);
      values.push_back(static_cast<std::int8_t>(std::clamp(units, -128.0, 127.0)));
    }
    return values;
  }

  BoostingOptions options_;
  const std::vector<std::uint8_t>& labels_;
  const std::vector<std::uint8_t>& held_out_;
  std::array<std::vector<std::uint8_t>, kFeatureCount> codes_;
  std::vector<std::int32_t> scores_;  ///< in leaf units, without the bias
  double bias_ = 0;
  std::array<double, kFeatureCount> gains_{};
  std::vector<std::int32_t> first_;  ///< derivatives, in units of kDerivativeUnit
  std::vector<std::int32_t> second_;
  std::vector<std::uint8_t> leaf_numbers_;
};

void checkOptions(const Samples& samples, const BoostingOptions& options) {
  requireForTraining(options.leaf_unit > 0 && options.regularization >= 0,
                     "leaf unit and regularization must be positive");
  requireBothClasses(samples);
  requireTreeCount(options.trees);
  requireForTraining(options.depth >= 1 && options.depth <= Forest::kMaxDepth,
                     "the depth must be in [1, " + std::to_string(Forest::kMaxDepth) + "]");
  requireForTraining(options.learning_rate > 0 && options.learning_rate <= 1,
                     "the learning rate must be in (0, 1]");
  requireForTraining(options.matchers.any(), "no matcher is left whose features trees may ask for");
}

}  // namespace

FeatureQuantizer fitQuantizer(const Samples& samples) {
  FeatureQuantizer quantizer;
  tbb::parallel_for(0, kMatcherCount, [&](int m) {
    const auto between = [&](int low, int high, float floor) {
      const CodeMap map =
          mapBetween(std::max(floor, quantile(samples.features[featureIndex(m, low)], 0.005)),
                     quantile(samples.features[featureIndex(m, high)], 0.995));
      quantizer.maps[featureIndex(m, low)] = map;
      quantizer.maps[featureIndex(m, high)] = map;
    };
    const float no_floor = -std::numeric_limits<float>::max();
    between(kCost, kCost, no_floor);
    between(kRatioLow, kRatioHigh, no_floor);
    between(kLikelihoodLow, kLikelihoodHigh, kLowestLogLikelihood);
  });
  return quantizer;
}

Forest trainForest(const Samples& samples, const BoostingOptions& options,
                   const BoostingProgress& progress) {
  checkOptions(samples, options);
  Forest forest;
  forest.quantizer = fitQuantizer(samples);
  forest.leaf_unit = options.leaf_unit;
  Booster booster(samples, options, forest.quantizer);
  forest.bias = booster.bias();
  for (int tree = 1; tree <= options.trees; ++tree) {
    forest.trees.push_back(booster.addTree());
    forest.provenance.held_out_log_loss = booster.heldOutLogLoss();
    progress(tree, forest.provenance.held_out_log_loss);
  }
  forest.provenance.samples = samples.count();
  forest.provenance.feature_importance = shares(booster.gains());
  return forest;
}

}  // namespace cbmv
