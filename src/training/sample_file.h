#pragma once

#include <string>

#include "training/sampling.h"

namespace cbmv {

/// Writes a CSV file: a head with the names of the features (feature_names.h) `label` (1 correct)
/// and `held_out` (1: not trained on), then a row a sample, with so many digits that reading gives
/// the same floats. Throws Error if the file cannot be written.
void writeSamples(const Samples& samples, const std::string& path);

}  // namespace cbmv
