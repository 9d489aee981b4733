#pragma once

#include <functional>
#include <string>
#include <vector>

#include "data_sets/data_set.h"
#include "evaluation/disparity_source.h"
#include "evaluation/evaluation_report.h"

namespace cbmv {

/// Callbacks of an evaluation; all must be set.
struct EvaluationEvents {
  std::function<void(const std::string&)> progress;  ///< a progress message
  std::function<void(const std::string&)> failure;   ///< the name of a failed scene and the error
  std::function<void(const StereoScene&, const SceneMaps&)> maps;  ///< the maps of a matched scene
  std::function<void(const EvaluationReport&)> scored;  ///< the report after a scene was added
};

/// Matches the scenes in this order and adds their scores to `report`, using `report.scoring`.
/// Scenes without ground truth are added by name only. Scenes already in the report are skipped. A
/// scene that cannot be read, matched or scored is passed to `failure` and left out. Returns the
/// number of failed scenes.
int evaluateScenes(const DataSet& data_set, const std::vector<std::string>& scenes,
                   const DisparitySource& source, const EvaluationEvents& events,
                   EvaluationReport& report);

/// Copies the results of `scenes`, scored or not, from `earlier` into `report`, which must have no
/// scenes. Returns the number of copied scenes, or −1 if the fingerprints or the scorings differ.
int resumeReport(const EvaluationReport& earlier, const DataSet& data_set,
                 const std::vector<std::string>& scenes, EvaluationReport& report);

}  // namespace cbmv
