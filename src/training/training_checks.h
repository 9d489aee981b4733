#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <string>
#include <vector>

#include "forest/forest.h"
#include "training/sample_labels.h"

#include "cbmv_stereo/error.h"

namespace cbmv {

inline void requireForTraining(bool good, const std::string& message) {
  if (!good) {
    throw Error("training: " + message);
  }
}

inline void requireTreeCount(int trees) {
  requireForTraining(
      trees >= 1 && trees <= Forest::kMaxTrees,
      "the number of trees must be in [1, " + std::to_string(Forest::kMaxTrees) + "]");
}

/// Of the samples that are trained on, and some that are not.
inline void requireBothClasses(const SampleLabels& samples) {
  std::array<long, 2> counts{};
  for (long n = 0; n < samples.count(); ++n) {
    counts[samples.labels[n]] += samples.held_out[n] == 1 ? 0 : 1;
  }
  requireForTraining(counts[0] > 0 && counts[1] > 0,
                     "correct and wrong samples are both needed, but there are " +
                         std::to_string(counts[1]) + " and " + std::to_string(counts[0]) +
                         " to train on");
  requireForTraining(
      counts[0] + counts[1] < samples.count(),
      "no sample is held out, expected some in a tenth of the rows of each scene. Use "
      "more scenes, or scenes whose truth covers more rows");
}

/// The parts of each in their sum.
inline std::vector<double> shares(std::vector<double> parts) {
  const double sum = std::accumulate(parts.begin(), parts.end(), 0.0);
  for (double& part : parts) {
    part = sum > 0 ? part / sum : 0;
  }
  return parts;
}

/// In nats, of a sample's label under the probability that it is 1.
inline double logLoss(double probability, std::uint8_t label) {
  return -std::log(std::max(1e-12, label == 1 ? probability : 1 - probability));
}

}  // namespace cbmv
