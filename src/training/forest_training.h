#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "data_sets/data_set.h"
#include "forest/forest.h"
#include "training/boosting.h"
#include "training/random_forest.h"
#include "training/sampling.h"

#include "cbmv_stereo/options.h"
#include "cbmv_stereo/vertical_offset.h"

namespace cbmv {

enum class ForestKind {
  kOblivious,    ///< boosted oblivious trees: for use
  kRandomForest  ///< the paper's forest: for research, slow
};

/// The second forest: see second_forest.h.
struct SecondForestOptions {
  bool enabled = true;             ///< of oblivious forests only
  int groups = 2;                  ///< of the cross-fitting
  long pixels_per_scene = 120000;  ///< at most, for each preset and each of both forests
  BoostingOptions confidence{64, 6, 0.15};
  /// Regularized more: proposals of one scene are much alike, and what is learnt of them has to
  /// hold in other scenes.
  BoostingOptions selection{64, 6, 0.15, 300.0};
  std::vector<StereoOptions> matching = {StereoOptions()};  ///< presets that it is made for
};

struct TrainingOptions {
  ForestKind kind = ForestKind::kOblivious;
  long pixels_per_scene = 100000;  ///< at most, of each level; each gives up to three samples
  /// Upper limit over all scenes; each scene gets the same share. First forest: samples. Second
  /// forest: pixels, which give up to five samples each. Not given: the default of the kind.
  std::optional<long> max_samples;
  /// The search that the forest is made for: samples come from all of its levels. 0 levels: from
  /// the full size and the whole range alone.
  SearchOptions search;
  /// Part of the pixels whose competitors are those of the search's windows, 0 … 1; the other ones
  /// have those of the whole range.
  double windowed_share = 0.7;
  std::uint64_t seed = 1;
  RectificationOptions rectification;  ///< as the pairs will be matched
  BoostingOptions boosting;            ///< of oblivious trees
  RandomForestOptions random_forest;   ///< of a random forest
  SecondForestOptions second;

  /// A sample of a random forest takes 20 times the memory.
  static constexpr long defaultMaxSamples(ForestKind kind) {
    return kind == ForestKind::kOblivious ? 6000000 : 3000000;
  }
  long maxSamples() const { return max_samples.value_or(defaultMaxSamples(kind)); }
};

/// "trees 64, depth 6, …": all options but the seed, for people.
std::string describe(const TrainingOptions& options);

/// A step of one of the phases of a training: checking scenes, sampling them, growing trees.
struct TrainingStep {
  std::string phase;  ///< "sampling"
  int done = 0;       ///< of `total`, this step included
  int total = 0;
  std::string line;  ///< for a log; empty where the step is not worth one
};

/// Called after each step.
using TrainingProgress = std::function<void(const TrainingStep&)>;

/// Called with a line for people now and then.
using TrainingReport = std::function<void(const std::string&)>;

/// Pixels drawn per scene and level for this number of scenes: options.pixels_per_scene, or
/// less so that no more than options.maxSamples() come together. Throws Error when that leaves
/// none.
long pixelsPerScene(std::size_t scenes, const TrainingOptions& options);

/// Draws the samples that a forest is trained on and measured with, from the pixels of these scenes
/// that both cameras see. With samples from windows, a first forest of oblivious trees is trained
/// on a quarter of the pixels at full size, and the windows are those that a search with it leaves.
/// Checks first that all scenes can be read. Holds one scene at a time.
/// Throws Error that names the scene or file that is wrong.
Samples drawSamples(const std::vector<SceneReference>& scenes, const TrainingOptions& options,
                    const TrainingProgress& progress);

/// Trains a forest on these samples of these scenes and measures it on those held out. Throws Error
/// that names the option that is wrong.
Forest trainOnSamples(const Samples& samples, const std::vector<SceneReference>& scenes,
                      const TrainingOptions& options, const TrainingProgress& progress);

/// Both of the above and trainSecondForest; `report` gets the lines of their steps.
Forest trainOnScenes(const std::vector<SceneReference>& scenes, const TrainingOptions& options,
                     const TrainingReport& report);

}  // namespace cbmv
