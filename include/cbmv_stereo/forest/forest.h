#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "cbmv_stereo/confidence/features.h"

namespace cbmv {

/// Where a forest comes from: for people and for `info`; the method does not read it.
struct ForestProvenance {
  std::string program;                 ///< name and version of the trainer
  std::string data_set;                ///< kind and name, no paths
  std::vector<std::string> scenes;     ///< the scenes that were seen in training
  std::string options;                 ///< options of the training, as text
  long samples = 0;                    ///< training samples
  std::uint64_t seed = 0;
  double held_out_log_loss = 0;        ///< nats per sample, on samples that were not trained on
};

/// A tree in which all nodes of a level ask the same question: the answers, one bit a level, are the
/// number of the leaf.
struct ObliviousTree {
  struct Level {
    std::uint8_t feature = 0;    ///< in [0, kFeatureCount)
    std::uint8_t threshold = 0;  ///< the level's bit is set where code ≥ threshold
  };
  std::vector<Level> levels;        ///< level k gives bit k of the leaf's number
  std::vector<std::int8_t> leaves;  ///< 2^levels, in units of Forest::leaf_unit of log-odds
};

/// Sum of oblivious trees on feature codes: log-odds that a hypothesis is correct.
struct Forest {
  static constexpr int kMaxDepth = 8;
  static constexpr int kMaxTrees = 1024;

  std::string name;  ///< for messages: the file's name without its folder
  FeatureQuantizer quantizer;
  double leaf_unit = 1.0 / 32;  ///< log-odds per unit of a leaf
  double bias = 0;              ///< log-odds before any tree
  std::vector<ObliviousTree> trees;
  ForestProvenance provenance;
};

/// Reads the file that writeForest writes (docs/forest.md has the format). Throws Error that names
/// the file and what is wrong: not there, not a forest, another version, damaged, out of range.
Forest readForest(const std::string& path);

/// Throws Error if the file cannot be written.
void writeForest(const Forest& forest, const std::string& path);

/// Throws Error that says what is wrong with it, if anything: sizes and ranges of all parts.
void validateForest(const Forest& forest, const std::string& file_name);

/// Applies a forest to rows of feature codes. Built once from a Forest, then read by any number of
/// threads.
class ForestEvaluator {
 public:
  explicit ForestEvaluator(const Forest& forest);

  /// `codes[f]` points to `count` codes of feature f. `costs[i]` becomes the matching cost of
  /// hypothesis i: 1 − probability, times 255, rounded (Batsos et al. 2018, section 3.3).
  void evaluate(const std::array<const std::uint8_t*, kFeatureCount>& codes, int count,
                std::uint8_t* costs) const;

 private:
  void accumulate(const ObliviousTree& tree,
                  const std::array<const std::uint8_t*, kFeatureCount>& codes, int first, int count,
                  std::int32_t* sums) const;

  std::vector<ObliviousTree> trees_;
  std::int32_t lowest_sum_ = 0;              ///< of all leaves
  std::vector<std::uint8_t> cost_of_sum_;    ///< indexed by sum − lowest_sum_
};

}  // namespace cbmv
