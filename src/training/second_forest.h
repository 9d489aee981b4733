#pragma once

#include <string>
#include <vector>

#include "data_sets/data_set.h"
#include "forest/forest.h"
#include "training/forest_training.h"

namespace cbmv {

/// Splits scenes into `groups` groups of about the same size, in their order. A scene whose name
/// begins with that of the one before (Piano, PianoL) joins its group, as it may show the same
/// place. Fewer groups than asked for where there are not enough scenes. Returns the group of each.
std::vector<int> crossFittingGroups(const std::vector<std::string>& names, int groups);

/// Trains the confidence forest and the selection forest of `forest`, which was trained on
/// `scenes`; nothing where options.second is not enabled, or for another kind than kOblivious.
///
/// They learn from maps of the same kind as they will see, so by cross-fitting: for each group of
/// scenes, a first forest is trained on the other groups and matches the scenes of the group. The
/// selection forest learns in the same way from confidences of forests that did not see the scene.
/// The model of the standard deviation is fitted to these, too. Leaves the
/// forest unchanged, and reports why, if there are fewer than two groups, or if without one group
/// the samples lack a class (correct or wrong). Trains no
/// selection forest where the truth covers less than half of the pixels. Holds the maps of all
/// scenes in memory, 19 bytes a pixel and preset, and the samples of so many pixels as
/// options.second.pixels_per_scene and options.maxSamples() allow.
void trainSecondForest(const std::vector<SceneReference>& scenes, const TrainingOptions& options,
                       const TrainingProgress& progress, Forest& forest);

}  // namespace cbmv
