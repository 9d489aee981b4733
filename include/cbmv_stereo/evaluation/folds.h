#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "cbmv_stereo/forest/forest.h"
#include "cbmv_stereo/io/data_set.h"
#include "cbmv_stereo/training/forest_training.h"

namespace cbmv {

/// The three folds of the paper's cross-validation on Middlebury v3 (Batsos et al. 2018, section
/// 4).
std::vector<std::vector<std::string>> middleburyFolds();

/// Index in middleburyFolds. Throws Error that names a scene of no fold.
std::size_t foldOf(const std::string& scene);

/// These scenes, fold after fold. Errors as foldOf.
std::vector<std::string> orderByFold(const std::vector<std::string>& scenes);

/// A forest, called "fold N", trained on those of `scenes` that lie in other folds. `report` is
/// trainOnScenes's. Throws Error when there are none, and as foldOf and trainOnScenes do.
Forest trainWithoutFold(std::size_t fold, const std::vector<SceneReference>& scenes,
                        const TrainingOptions& training,
                        const std::function<void(const std::string&)>& report);

/// One such forest for each fold that has a scene among `wanted`, trained on those of `pool`; only
/// scenes of Middlebury v3 count. Throws Error when there are none of it among `wanted`.
std::vector<std::shared_ptr<const Forest>> trainFolds(
    const std::vector<SceneReference>& wanted, const std::vector<SceneReference>& pool,
    const TrainingOptions& training, const std::function<void(const std::string&)>& report);

}  // namespace cbmv
