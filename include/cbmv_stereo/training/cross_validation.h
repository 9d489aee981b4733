#pragma once

#include <functional>
#include <string>
#include <vector>

#include "cbmv_stereo/evaluation/disparity_source.h"
#include "cbmv_stereo/io/data_set.h"
#include "cbmv_stereo/pipeline/options.h"
#include "cbmv_stereo/training/forest_training.h"

namespace cbmv {

/// The three folds of the paper's cross-validation on Middlebury v3 (Batsos et al. 2018, section
/// 4).
std::vector<std::vector<std::string>> middleburyFolds();

/// These scenes, fold after fold. Throws Error that names a scene of no fold.
std::vector<std::string> orderByFold(const std::vector<std::string>& scenes);

/// Matches each scene with a forest trained on those of `scenes` that lie in other folds. Keeps the
/// forest of the fold asked last: ask in the order of orderByFold. `report` is trainOnScenes's.
DisparitySource foldSource(const std::vector<SceneReference>& scenes,
                           const TrainingOptions& training, const StereoOptions& options,
                           const TrainingReport& report);

}  // namespace cbmv
