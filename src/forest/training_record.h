#pragma once

#include <string>
#include <vector>

namespace cbmv {

/// Samples that a forest gives about the same probability.
struct ReliabilityBin {
  double predicted = 0;  ///< mean probability
  double observed = 0;   ///< part of them that is correct
  long samples = 0;
};

/// How a forest was trained and what it reached: for people; the method does not read it.
struct TrainingRecord {
  std::string options;           ///< options of the training, as text
  long samples = 0;              ///< training samples
  double held_out_log_loss = 0;  ///< nats per sample, on samples that were not trained on
  /// On the same samples, in order of probability; empty: not measured.
  std::vector<ReliabilityBin> reliability;
  double calibration_error = 0;  ///< expected: mean over the samples of |predicted − observed|
  /// Of each feature, the part of what all splits gained, sum 1; empty: not measured.
  std::vector<double> feature_importance;
};

}  // namespace cbmv
