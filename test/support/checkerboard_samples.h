#pragma once

#include <random>
#include <vector>

#include "training/sampling.h"

namespace cbmv::test {

/// Uniform features; every tenth sample is held out. A sample is correct with probability 0.9 if
/// feature 2 is above and feature 15 below its middle, else with probability 0.1.
inline Samples checkerboard(int count) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> uniform(0, 1);
  Samples samples;
  for (int n = 0; n < count; ++n) {
    for (std::vector<float>& column : samples.features) {
      column.push_back(uniform(random));
    }
    const bool likely = samples.features[2].back() > 0.5F && samples.features[15].back() < 0.5F;
    samples.held_out.push_back(n % 10 == 0 ? 1 : 0);
    samples.labels.push_back(uniform(random) < (likely ? 0.9F : 0.1F) ? 1 : 0);
  }
  return samples;
}

}  // namespace cbmv::test
