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

/// Returns the maps of a scene. Throws when the scene has none. Call it for one scene at a time.
using DisparitySource = std::function<SceneMaps(const StereoScene&)>;

/// Converts the result of the matcher; infinity where there is no disparity.
SceneMaps toSceneMaps(const StereoResult& result);

/// Matches each scene with this forest over the disparity range of the data set, or over the range
/// found in the pair if options.range is automatic. Throws Error immediately when the options are
/// inconsistent.
DisparitySource matchingSource(std::shared_ptr<const Forest> forest, const StereoOptions& options);

/// Reads `folder`/SCENE.pfm or, if it does not exist, SCENE.png (16 bits, disparity = value / 256,
/// 0 = none). SCENE_confidence.pfm and SCENE_sigma.pfm are optional. All sizes must equal the
/// scene's.
DisparitySource fileSource(const std::string& folder);

/// Writes SCENE.pfm (no disparity: infinity) and, if known, SCENE_confidence.pfm and
/// SCENE_sigma.pfm. fileSource reads the same maps back, except for the time.
void writeMaps(const std::string& folder, const StereoScene& scene, const SceneMaps& maps);

}  // namespace cbmv
