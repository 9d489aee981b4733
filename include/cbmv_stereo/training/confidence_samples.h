#pragma once

#include <string>
#include <vector>

#include "cbmv_stereo/training/sample_labels.h"

namespace cbmv {

/// Labelled disparities for a confidence forest: values of its features, and whether the disparity
/// is correct.
struct ConfidenceSamples : SampleLabels {
  std::vector<std::string> feature_names;    ///< in the order of the columns
  std::vector<std::vector<float>> features;  ///< one column a feature, finite
};

}  // namespace cbmv
