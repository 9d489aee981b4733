#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "forest/oblivious_forest.h"
#include "forest/training_record.h"

namespace cbmv {

/// The probability that a disparity is within 1 px of the truth, from features of the pixel and of
/// the maps around it, all bytes. The forest knows its features by name; the code that computes
/// them checks that they are the ones it has (requireFeatures).
struct ConfidenceForest : ObliviousForest {
  static constexpr int kMaxFeatures = 64;
  // cppcheck-suppress duplInheritedMember  // fewer than other forests have
  static constexpr int kMaxTrees = 256;            ///< the sum of their leaves fits 16 bits
  static constexpr int kSigmaConfidenceBins = 10;  ///< of the probability, of equal widths
  static constexpr int kSigmaRoughnessBins = 4;
  static constexpr double kMaxSigmaPx = 10;
  static constexpr const char* kRoughness = "roughness_5";  ///< the feature of the roughness bins

  std::vector<std::string> feature_names;  ///< in order; at most kMaxFeatures, all different
  /// Standard deviation of the disparity in px, in (0, kMaxSigmaPx], of [roughness bin][confidence
  /// bin], row by row. Empty: there is no such model.
  std::vector<double> sigma_px;
  /// Limits between the roughness bins, rising: bin k begins at limit k − 1.
  std::array<std::uint8_t, kSigmaRoughnessBins - 1> sigma_roughness_bounds{};
  TrainingRecord record;  ///< data set, scenes and seed are those of the file

  bool hasSigma() const { return !sigma_px.empty(); }
  /// Bin of a value of kRoughness.
  int roughnessBin(std::uint8_t roughness) const {
    int bin = 0;
    for (const std::uint8_t bound : sigma_roughness_bounds) {
      bin += roughness >= bound ? 1 : 0;
    }
    return bin;
  }
  /// Number of a bin of sigma_px; `confidence` in 1/255.
  static int sigmaBin(int roughness_bin, std::uint8_t confidence) {
    return roughness_bin * kSigmaConfidenceBins + confidence * kSigmaConfidenceBins / 256;
  }
  float sigmaPx(int roughness_bin, std::uint8_t confidence) const {
    return static_cast<float>(sigma_px[sigmaBin(roughness_bin, confidence)]);
  }
};

/// Throws Error that names the file of the forest, its stage ("confidence" or "selection") and the
/// first feature that differs, if the forest has other features, or in another order, than `names`.
void requireFeatures(const ConfidenceForest& forest, const std::string& stage,
                     const std::vector<std::string>& names, const std::string& file_name);

}  // namespace cbmv
