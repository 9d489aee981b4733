#include "evaluation/evaluation.h"

#include <cmath>
#include <exception>
#include <optional>
#include <sstream>

#include "pipeline/machine_memory.h"

namespace cbmv {
namespace {

struct MatchedScene {
  StereoScene scene;
  SceneMaps maps;
  std::optional<SceneScore> score;  ///< nothing: no ground truth
};

/// Returns nothing if the scene failed.
std::optional<MatchedScene> tryScene(const DataSet& data_set, const std::string& name,
                                     const DisparitySource& source, const ScoreOptions& scoring,
                                     const EvaluationEvents& events) {
  try {
    MatchedScene matched;
    matched.scene = data_set.read(name);
    matched.maps = source(matched.scene);
    if (!matched.scene.truth.empty()) {
      matched.score = scoreScene(matched.scene, matched.maps, scoring);
      matched.score->weight = data_set.weight(name);
    }
    return matched;
  } catch (const std::exception& error) {
    events.failure("scene " + name + " failed: " + describeFailure(error));
    return std::nullopt;
  }
}

std::string summary(const MatchedScene& matched) {
  constexpr std::size_t kBad1 = 1;  // index in kMetrics
  std::ostringstream line;
  line.precision(2);
  line << std::fixed << matched.scene.name << ": ";
  if (matched.score) {
    line << "bad 1 " << matched.score->noc[kBad1] << " % of the non-occluded, "
         << matched.score->all[kBad1] << " % of all pixels";
  } else {
    line << "matched, not scored as it has no ground truth";
  }
  if (!std::isnan(matched.maps.seconds)) {
    line << ", " << matched.maps.seconds << " s";
  }
  return line.str();
}

}  // namespace

int evaluateScenes(const DataSet& data_set, const std::vector<std::string>& scenes,
                   const DisparitySource& source, const EvaluationEvents& events,
                   EvaluationReport& report) {
  int failed = 0;
  for (const std::string& name : scenes) {
    if (report.has(name)) {
      events.progress(name + ": done earlier");
      continue;
    }
    const std::optional<MatchedScene> matched =
        tryScene(data_set, name, source, report.scoring, events);
    if (!matched) {
      ++failed;
      continue;
    }
    events.maps(matched->scene, matched->maps);
    if (matched->score) {
      report.insert(*matched->score);
    } else {
      report.unscored.insert(name);
    }
    events.scored(report);
    events.progress(summary(*matched));
  }
  return failed;
}

int resumeReport(const EvaluationReport& earlier, const DataSet& data_set,
                 const std::vector<std::string>& scenes, EvaluationReport& report) {
  if (earlier.fingerprint != report.fingerprint || !(earlier.scoring == report.scoring)) {
    return -1;
  }
  for (const std::string& name : scenes) {
    if (const SceneScore* found = earlier.find(name)) {
      SceneScore score = *found;
      score.weight = data_set.weight(name);
      report.insert(score);
    } else if (earlier.has(name)) {
      report.unscored.insert(name);
    }
  }
  return static_cast<int>(report.scenes.size() + report.unscored.size());
}

}  // namespace cbmv
