#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "data_sets/data_set.h"
#include "evaluation/disparity_source.h"
#include "evaluation/folds.h"
#include "forest/forest.h"
#include "training/forest_training.h"

#include "cbmv_stereo/options.h"

namespace cbmv {

/// A forest, called "fold N", trained on those of `scenes` that lie in other folds. `report` is
/// trainOnScenes's. Throws Error when there are none, and as foldOf and trainOnScenes do.
Forest trainWithoutFold(std::size_t fold, const std::vector<SceneReference>& scenes,
                        const TrainingOptions& training, const TrainingReport& report);

/// One such forest for each fold that has a scene among `wanted`, trained on those of `pool`; only
/// scenes of Middlebury v3 count. Throws Error when there are none of it among `wanted`.
std::vector<std::shared_ptr<const Forest>> trainFolds(const std::vector<SceneReference>& wanted,
                                                      const std::vector<SceneReference>& pool,
                                                      const TrainingOptions& training,
                                                      const TrainingReport& report);

/// Matches each scene with a forest trained on those of `scenes` that lie in other folds. Keeps the
/// forest of the fold asked last: ask in the order of orderByFold. `options`: one for all folds, or
/// one for each in their order. `report` is trainOnScenes's. Throws Error when they are of another
/// number, and as foldOf at once, as trainWithoutFold from the source.
DisparitySource foldSource(const std::vector<SceneReference>& scenes,
                           const TrainingOptions& training,
                           const std::vector<StereoOptions>& options, const TrainingReport& report);

}  // namespace cbmv
