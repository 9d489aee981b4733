#pragma once

#include <functional>
#include <string>
#include <vector>

#include "data_sets/data_set.h"
#include "evaluation/disparity_source.h"
#include "evaluation/evaluation_report.h"

namespace cbmv {

/// What an evaluation tells while it runs; all of them must be set.
struct EvaluationEvents {
  std::function<void(const std::string&)> progress;  ///< a line for people
  std::function<void(const std::string&)> failure;   ///< a scene and what is wrong with it
  std::function<void(const StereoScene&, const SceneMaps&)> maps;  ///< of a scene that was matched
  std::function<void(const EvaluationReport&)> scored;             ///< the report has a scene more
};

/// Matches the scenes, in this order, and puts their scores into `report`, or only their names
/// where there is no ground truth, by `report.scoring`; leaves alone those that are in it already.
/// A scene that cannot be read, matched or scored is told by `failure` and left out. Returns how
/// many these are.
int evaluateScenes(const DataSet& data_set, const std::vector<std::string>& scenes,
                   const DisparitySource& source, const EvaluationEvents& events,
                   EvaluationReport& report);

/// Takes over into `report`, which has no scenes yet, those of `scenes` that an earlier report of
/// the same fingerprint and scoring holds, scored or not. Returns how many these are, −1 when the
/// fingerprints or scorings differ.
int resumeReport(const EvaluationReport& earlier, const DataSet& data_set,
                 const std::vector<std::string>& scenes, EvaluationReport& report);

}  // namespace cbmv
