#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "cbmv_stereo/forest/oblivious_forest.h"
#include "cbmv_stereo/forest/training_record.h"

namespace cbmv {

/// A part of the second forest: the probability that a disparity is correct, from features of the
/// pixel and of the maps around it. Features are bytes. It knows them by name; the code that computes
/// them checks that they are the ones it has (requireFeatures).
///
/// The confidence forest may have a model of the standard deviation of correct disparities: a table
/// over bins of the roughness around the pixel and of the probability.
struct ConfidenceForest : ObliviousForest {
  static constexpr int kMaxFeatures = 64;
  static constexpr int kMaxTrees = 256;  ///< the sum of their leaves fits 16 bits
  static constexpr int kSigmaConfidenceBins = 10;
  static constexpr int kSigmaRoughnessBins = 4;
  static constexpr int kSigmaBins = kSigmaRoughnessBins * kSigmaConfidenceBins;
  static constexpr double kHighestSigmaPx = 10;

  std::vector<std::string> feature_names;  ///< in order; at most kMaxFeatures, all different
  /// Standard deviations, [roughness bin][confidence bin]; kSigmaBins values, or none.
  std::vector<double> sigma_px;
  /// The lowest roughness of each bin but the first, ascending.
  std::array<std::uint8_t, kSigmaRoughnessBins - 1> sigma_roughness_bounds{};
  TrainingRecord record;  ///< data set, scenes and seed are those of the file

  bool hasSigma() const { return !sigma_px.empty(); }
  /// Bin of the feature roughness_5.
  int roughnessBin(std::uint8_t roughness) const {
    int bin = 0;
    for (const std::uint8_t bound : sigma_roughness_bounds) {
      bin += roughness >= bound ? 1 : 0;
    }
    return bin;
  }
  /// Number of a bin in the table; `confidence` in 1/255.
  static int sigmaBin(int roughness_bin, std::uint8_t confidence) {
    return roughness_bin * kSigmaConfidenceBins + confidence * kSigmaConfidenceBins / 256;
  }
  float sigmaPx(int roughness_bin, std::uint8_t confidence) const {
    return static_cast<float>(sigma_px[sigmaBin(roughness_bin, confidence)]);
  }
};

/// Throws Error that names the file of the forest and the first feature that differs, if the forest
/// has other features, or in another order, than `names`.
void requireFeatures(const ConfidenceForest& forest, const std::vector<std::string>& names,
                     const std::string& file_name);

}  // namespace cbmv
