#pragma once

#include <functional>
#include <memory>
#include <string>

#include "data_sets/stereo_scene.h"
#include "evaluation/scene_score.h"
#include "forest/forest.h"

#include "cbmv_stereo/options.h"
#include "cbmv_stereo/stereo_result.h"

namespace cbmv {

/// Where the maps of a scene come from. Throws when the scene has none; works on scene after scene.
using DisparitySource = std::function<SceneMaps(const StereoScene&)>;

/// What the matcher found as it is scored: infinity where there is no disparity.
SceneMaps toSceneMaps(const StereoResult& result);

/// Matches each scene with this forest, over the data set's range or, where options.range is
/// automatic, over the one that is found in the pair. Throws Error at once when the
/// options are inconsistent.
DisparitySource matchingSource(std::shared_ptr<const Forest> forest, const StereoOptions& options);

/// Reads `folder`/SCENE.pfm or, without it, SCENE.png (16 bits, value / 256, 0 = none), and
/// SCENE_confidence.pfm and SCENE_sigma.pfm where they are there. Sizes must be those of the scene.
DisparitySource fileSource(const std::string& folder);

/// Writes SCENE.pfm (no disparity: infinity) and, where they are known, SCENE_confidence.pfm and
/// SCENE_sigma.pfm, so that fileSource gives the same maps, except for the time.
void writeMaps(const std::string& folder, const StereoScene& scene, const SceneMaps& maps);

}  // namespace cbmv
