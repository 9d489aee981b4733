#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string>

#include "cbmv_stereo/error.h"
#include "cbmv_stereo/training/sampling.h"

namespace cbmv {

inline void requireForTraining(bool good, const std::string& sentence) {
  if (!good) {
    throw Error("training: " + sentence);
  }
}

/// Of the samples that are trained on: all but each `held_out_every`-th.
inline void requireBothClasses(const Samples& samples, int held_out_every) {
  requireForTraining(held_out_every >= 2, "the held-out step must be at least 2");
  std::array<long, 2> counts{};
  for (long n = 0; n < samples.count(); ++n) {
    counts[samples.labels[n]] += n % held_out_every == 0 ? 0 : 1;
  }
  requireForTraining(counts[0] > 0 && counts[1] > 0,
                     "correct and wrong samples are both needed, there are " +
                         std::to_string(counts[1]) + " and " + std::to_string(counts[0]) +
                         " to train on");
}

/// In nats, of a sample's label under the probability that it is 1.
inline double logLoss(double probability, std::uint8_t label) {
  return -std::log(std::max(1e-12, label == 1 ? probability : 1 - probability));
}

}  // namespace cbmv
