#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "cbmv_stereo/forest/forest.h"
#include "cbmv_stereo/io/data_set.h"
#include "cbmv_stereo/rectification/vertical_offset.h"
#include "cbmv_stereo/training/boosting.h"

namespace cbmv {

struct TrainingOptions {
  long pixels_per_scene = 40000;  ///< each gives up to three samples
  std::uint64_t seed = 1;
  RectificationOptions rectification;  ///< as the pairs will be matched
  BoostingOptions boosting;
};

/// "trees 64, depth 6, …": all options but the seed, for people.
std::string describe(const TrainingOptions& options);

/// Trains a forest on these scenes, drawing from the pixels that both cameras see. `report` is
/// called with a line for people now and then. Checks that all scenes can be read before the
/// training starts. Throws Error that names the scene, file or option that is wrong.
Forest trainOnScenes(const std::vector<SceneReference>& scenes, const TrainingOptions& options,
                     const std::function<void(const std::string&)>& report);

}  // namespace cbmv
