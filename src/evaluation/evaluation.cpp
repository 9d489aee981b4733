#include "cbmv_stereo/evaluation/evaluation.h"

#include <cmath>
#include <exception>
#include <optional>
#include <sstream>

namespace cbmv {
namespace {

struct ScoredScene {
  StereoScene scene;
  SceneMaps maps;
  SceneScore score;
};

/// Nothing when the scene failed.
std::optional<ScoredScene> tryScene(const DataSet& data_set, const std::string& name,
                                    const DisparitySource& source, const EvaluationEvents& events) {
  try {
    ScoredScene scored;
    scored.scene = data_set.read(name);
    scored.maps = source(scored.scene);
    scored.score = scoreScene(scored.scene, scored.maps);
    scored.score.weight = data_set.weight(name);
    return scored;
  } catch (const std::exception& error) {
    events.failure("scene " + name + " is left out: " + error.what());
    return std::nullopt;
  }
}

std::string summary(const SceneScore& score) {
  constexpr std::size_t kBad1 = 1;  // in kMetrics
  std::ostringstream line;
  line.precision(2);
  line << std::fixed << score.scene << ": bad 1 " << score.noc[kBad1] << " % of the non-occluded, "
       << score.all[kBad1] << " % of all pixels";
  if (!std::isnan(score.seconds)) {
    line << ", " << score.seconds << " s";
  }
  return line.str();
}

}  // namespace

int evaluateScenes(const DataSet& data_set, const std::vector<std::string>& scenes,
                   const DisparitySource& source, const EvaluationEvents& events,
                   EvaluationReport& report) {
  int failed = 0;
  for (const std::string& name : scenes) {
    if (report.find(name) != nullptr) {
      events.progress(name + ": scored earlier");
      continue;
    }
    const std::optional<ScoredScene> scored = tryScene(data_set, name, source, events);
    if (!scored) {
      ++failed;
      continue;
    }
    report.insert(scored->score);
    events.maps(scored->scene, scored->maps);
    events.scored(report);
    events.progress(summary(scored->score));
  }
  return failed;
}

int resumeReport(const EvaluationReport& earlier, const DataSet& data_set,
                 const std::vector<std::string>& scenes, EvaluationReport& report) {
  if (earlier.fingerprint != report.fingerprint) {
    return -1;
  }
  for (const std::string& name : scenes) {
    if (const SceneScore* found = earlier.find(name)) {
      SceneScore score = *found;
      score.weight = data_set.weight(name);
      report.insert(score);
    }
  }
  return static_cast<int>(report.scenes.size());
}

}  // namespace cbmv
