#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "cbmv_stereo/forest/forest.h"
#include "cbmv_stereo/rectification/vertical_offset.h"
#include "cbmv_stereo/training/boosting.h"

namespace cbmv {

struct TrainingOptions {
  std::vector<std::string> scenes;           ///< only these; empty: all of the data set
  std::vector<std::string> excluded_scenes;  ///< none of these
  long pixels_per_scene = 40000;             ///< each gives up to three samples
  std::uint64_t seed = 1;
  RectificationOptions rectification;  ///< as the pairs will be matched
  BoostingOptions boosting;
};

/// Trains a forest on a data set, "KIND:DIR". The only KIND so far is middlebury_v3. `report` is
/// called with a line for people now and then. Checks that all scenes can be read before the
/// training starts. Throws Error that names the data set, scene or file that is wrong.
Forest trainOnDataSet(const std::string& data_set, const TrainingOptions& options,
                      const std::function<void(const std::string&)>& report);

}  // namespace cbmv
