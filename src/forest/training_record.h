#pragma once

#include <string>
#include <vector>

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

}  // namespace cbmv
