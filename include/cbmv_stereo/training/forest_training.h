#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "cbmv_stereo/forest/forest.h"
#include "cbmv_stereo/io/data_set.h"
#include "cbmv_stereo/rectification/vertical_offset.h"
#include "cbmv_stereo/training/boosting.h"
#include "cbmv_stereo/training/random_forest.h"
#include "cbmv_stereo/training/sampling.h"

namespace cbmv {

enum class ForestKind {
  kOblivious,    ///< boosted oblivious trees: for use
  kRandomForest  ///< the paper's forest: for research, slow
};

struct TrainingOptions {
  ForestKind kind = ForestKind::kOblivious;
  long pixels_per_scene = 40000;  ///< each gives up to three samples
  std::uint64_t seed = 1;
  RectificationOptions rectification;  ///< as the pairs will be matched
  BoostingOptions boosting;            ///< of oblivious trees
  RandomForestOptions random_forest;   ///< of a random forest
};

/// "trees 64, depth 6, …": all options but the seed, for people.
std::string describe(const TrainingOptions& options);

/// Called with a line for people now and then.
using TrainingReport = std::function<void(const std::string&)>;

/// Draws the samples that a forest is trained on, from the pixels of these scenes that both cameras
/// see. Checks first that all scenes can be read. Throws Error that names the scene or file that is
/// wrong.
Samples drawSamples(const std::vector<SceneReference>& scenes, const TrainingOptions& options,
                    const TrainingReport& report);

/// Trains a forest on these samples of these scenes. Throws Error that names the option that is
/// wrong.
Forest trainOnSamples(const Samples& samples, const std::vector<SceneReference>& scenes,
                      const TrainingOptions& options, const TrainingReport& report);

/// Both of the above.
Forest trainOnScenes(const std::vector<SceneReference>& scenes, const TrainingOptions& options,
                     const TrainingReport& report);

}  // namespace cbmv
