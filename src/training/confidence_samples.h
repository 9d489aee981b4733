#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "training/sample_labels.h"

namespace cbmv {

/// Labeled disparities for a confidence forest: its features, which are bytes, and whether the
/// disparity is correct.
struct ConfidenceSamples : SampleLabels {
  std::vector<std::string> feature_names;           ///< in the order of the columns
  std::vector<std::vector<std::uint8_t>> features;  ///< one column per feature
};

}  // namespace cbmv
