#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "cbmv_stereo/confidence/features.h"

namespace cbmv {

/// Where a forest comes from: for people and for `info`; the method does not read it.
struct ForestProvenance {
  std::string program;              ///< name and version of the trainer
  std::string data_set;             ///< kind and name, no paths
  std::vector<std::string> scenes;  ///< the scenes that were seen in training
  std::string options;              ///< options of the training, as text
  long samples = 0;                 ///< training samples
  std::uint64_t seed = 0;
  double held_out_log_loss = 0;  ///< nats per sample, on samples that were not trained on
};

/// A tree in which all nodes of a level ask the same question: the answers, one bit a level, are
/// the number of the leaf.
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

}  // namespace cbmv
