#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "forest/oblivious_forest.h"
#include "training/boosting.h"
#include "training/sample_labels.h"

namespace cbmv {

/// State of a training of oblivious trees over any features: codes and current log-odds of every
/// sample. Sums are of integers, so that neither threads nor the order of samples matter.
class Booster {
 public:
  using Column = std::vector<std::uint8_t>;

  /// `codes`: a column per feature; `asked`: whether trees may ask for it. `codes` and `labels`
  /// have to outlive the object.
  Booster(const std::vector<Column>& codes, std::vector<bool> asked, const SampleLabels& labels,
          const BoostingOptions& options);

  /// Log-odds of the samples that are trained on.
  double bias() const { return bias_; }

  /// Grows the next tree.
  ObliviousTree addTree();

  /// With the trees so far, nats a sample.
  double heldOutLogLoss() const;

  /// What the questions of all trees lowered the loss by, times two, by feature.
  const std::vector<double>& gains() const { return gains_; }

 private:
  static constexpr int kCodes = 256;

  /// Of the loss by the log-odds, in fixed point; `Integer` holds those of a sample or a sum.
  template <typename Integer>
  struct Derivatives {
    Integer first = 0;
    Integer second = 0;
  };
  using Sum = Derivatives<std::int64_t>;
  /// Of the samples of one leaf, by the code of a feature.
  using Histogram = std::array<Sum, kCodes>;

  struct Question {
    ObliviousTree::Level level;
    double gain = -1;  ///< what it lowers the loss by, times two
  };

  /// A share of the samples, with those of them whose histograms are summed up at a level.
  struct Chunk {
    std::size_t begin = 0;
    std::size_t end = 0;
    std::size_t selected = 0;
    std::vector<std::uint32_t> samples;
    std::vector<std::uint8_t> leaves;
    std::vector<Derivatives<std::int32_t>> derivatives;
  };

  double logOdds(std::int32_t score) const { return bias_ + options_.leaf_unit * score; }
  void computeDerivatives();
  void select(int depth, const std::vector<long>& leaf_sizes);
  void fillChunk(const std::vector<std::uint8_t>& is_summed, Chunk& chunk);
  Question bestQuestion(int depth);
  Question bestThreshold(int feature, int depth);
  void sumHistograms(int feature, int depth);
  void addScores(const Histogram& histogram, std::array<double, kCodes>& scores) const;
  double score(const Sum& sum) const;
  std::vector<long> splitLeaves(const ObliviousTree::Level& level, int depth);
  std::vector<std::int8_t> leafValues(const ObliviousTree::Level& last) const;
  std::int8_t leafValue(const Sum& sum) const;

  BoostingOptions options_;
  const std::vector<Column>& codes_;
  std::vector<bool> asked_;
  const SampleLabels& labels_;
  double bias_ = 0;
  std::vector<std::int32_t> scores_;  ///< in leaf units, without the bias
  std::vector<double> gains_;

  std::vector<Derivatives<std::int32_t>> derivatives_;
  std::vector<std::uint8_t> leaf_numbers_;
  std::vector<Chunk> chunks_;
  std::vector<std::vector<Histogram>> histograms_;  ///< [feature][leaf], of the current level
  /// Leaves that the histograms are summed up of; their siblings get what is left of the parent's.
  std::vector<int> summed_leaves_;
};

}  // namespace cbmv
