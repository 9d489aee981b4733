#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "forest/oblivious_forest.h"

namespace cbmv {

/// Samples with similar predicted probability.
struct ReliabilityBin {
  double predicted = 0;  ///< mean probability
  double observed = 0;   ///< fraction of correct samples
  long samples = 0;
};

/// Training and quality of a forest, for users. The method does not use it.
struct TrainingRecord {
  std::string options;           ///< options of the training, as text
  long samples = 0;              ///< training samples
  double held_out_log_loss = 0;  ///< nats per sample, on samples not used in training
  /// On the same samples, ordered by probability. Empty: not measured.
  std::vector<ReliabilityBin> reliability;
  /// Expected calibration error: mean over the samples of |predicted − observed|
  double calibration_error = 0;
  /// Fraction of the total gain of all splits per feature; the sum is 1. Empty: not measured.
  std::vector<double> feature_importance;
};

/// Forest for the probability that a disparity is within 1 px of the true disparity. Its features
/// are of the pixel and of the maps around it; all are bytes. It has the names of its features. The
/// code that computes the features checks that they are the same (requireFeatures).
struct ConfidenceForest : ObliviousForest {
  static constexpr int kMaxFeatures = 64;
  // cppcheck-suppress duplInheritedMember  // fewer than other forests have
  static constexpr int kMaxTrees = 256;            ///< the sum of their leaves fits into 16 bits
  static constexpr int kSigmaConfidenceBins = 10;  ///< bins of the probability, with equal widths
  static constexpr int kSigmaRoughnessBins = 4;
  static constexpr double kMaxSigmaPx = 10;
  static constexpr const char* kRoughness = "roughness_5";  ///< feature for the roughness bins

  std::vector<std::string> feature_names;  ///< in order, at most kMaxFeatures, unique
  /// Standard deviation of the disparity in px, in (0, kMaxSigmaPx], laid out [roughness
  /// bin][confidence bin]. Empty: the forest has no model of it.
  std::vector<double> sigma_px;
  /// Ascending bounds between the roughness bins: bin k begins at bound k − 1.
  std::array<std::uint8_t, kSigmaRoughnessBins - 1> sigma_roughness_bounds{};
  TrainingRecord record;  ///< data set, scenes and seed are those of the file

  bool hasSigma() const { return !sigma_px.empty(); }
  /// Bin for a value of the feature kRoughness.
  int roughnessBin(std::uint8_t roughness) const {
    int bin = 0;
    for (const std::uint8_t bound : sigma_roughness_bounds) {
      bin += roughness >= bound ? 1 : 0;
    }
    return bin;
  }
  /// Index into sigma_px. `confidence` is in 1/255.
  static int sigmaBin(int roughness_bin, std::uint8_t confidence) {
    return roughness_bin * kSigmaConfidenceBins + confidence * kSigmaConfidenceBins / 256;
  }
  float sigmaPx(int roughness_bin, std::uint8_t confidence) const {
    return static_cast<float>(sigma_px[sigmaBin(roughness_bin, confidence)]);
  }
};

/// Throws Error if the features of the forest are not `names` in this order. The text names the
/// forest file, the stage ("confidence" or "selection") and the first feature that differs.
void requireFeatures(const ConfidenceForest& forest, const std::string& stage,
                     const std::vector<std::string>& names, const std::string& file_name);

}  // namespace cbmv
