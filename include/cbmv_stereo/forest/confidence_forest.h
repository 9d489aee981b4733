#pragma once

#include <array>
#include <string>
#include <vector>

#include "cbmv_stereo/forest/oblivious_forest.h"
#include "cbmv_stereo/forest/training_record.h"

namespace cbmv {

/// The second forest: the probability that a disparity is correct, from features of the pixel and
/// of the maps around it. It knows its features by name; the code that computes them checks that
/// they are the ones it has (requireFeatures).
struct ConfidenceForest : ObliviousForest {
  static constexpr int kMaxFeatures = 64;
  static constexpr int kMaxTrees = 256;  ///< the sum of their leaves fits 16 bits
  static constexpr int kMaxSigmaCoefficients = 64;

  std::vector<std::string> feature_names;  ///< in order; at most kMaxFeatures, all different
  /// The model of the standard deviation of the disparity; empty: there is none.
  std::vector<double> sigma_coefficients;
  std::array<double, 2> sigma_bounds_px{};  ///< the lowest and the highest standard deviation
  TrainingRecord record;                    ///< data set, scenes and seed are those of the file
};

/// Throws Error that names the file of the forest and the first feature that differs, if the forest
/// has other features, or in another order, than `names`.
void requireFeatures(const ConfidenceForest& forest, const std::vector<std::string>& names,
                     const std::string& file_name);

}  // namespace cbmv
