#include "tuning/tuning.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numeric>

#include <tbb/task_arena.h>

#include "evaluation/folds.h"
#include "evaluation/scene_score.h"
#include "tuning/tuning_scene.h"

#include "cbmv_stereo/error.h"

namespace cbmv {
namespace {

constexpr double kLeastError = 1e-6;  // lower limit of the start's error, which is a divisor

using Indices = std::vector<std::size_t>;

/// Names of the data sets in their order.
std::vector<std::string> dataSetsOf(const std::vector<SceneReference>& scenes) {
  std::vector<std::string> names;
  for (const SceneReference& scene : scenes) {
    if (std::count(names.begin(), names.end(), scene.data_set.name()) == 0) {
      names.push_back(scene.data_set.name());
    }
  }
  return names;
}

/// One per data set.
std::vector<ErrorSum> parseObjectives(const std::vector<std::string>& names,
                                      std::size_t data_sets) {
  if (names.size() != 1 && names.size() != data_sets) {
    throw Error("there are " + std::to_string(names.size()) + " objectives and " +
                std::to_string(data_sets) +
                " data sets, expected one objective for all, or one for each. Correct --objective");
  }
  std::vector<ErrorSum> objectives;
  objectives.reserve(data_sets);
  for (const std::string& name : names) {
    objectives.push_back(parseErrorSum(name));
  }
  objectives.resize(data_sets, objectives.front());
  return objectives;
}

void requireFolds(const std::vector<SceneReference>& scenes) {
  Indices folds;
  for (const SceneReference& scene : scenes) {
    if (scene.data_set.kind() != "middlebury_v3") {
      throw Error("data set " + scene.data_set.name() +
                  ": has no folds, expected Middlebury v3. Leave out --cross-validate");
    }
    folds.push_back(foldOf(scene.scene));
  }
  if (std::count(folds.begin(), folds.end(), folds.front()) == static_cast<long>(folds.size())) {
    throw Error("cross-validation needs scenes of at least two folds, but all are of fold " +
                std::to_string(folds.front() + 1));
  }
}

/// Result of a search; means over the scenes of each data set, NaN where it has none.
struct Finding {
  StereoOptions options;
  std::vector<double> before;
  std::vector<double> after;
  int evaluations = 0;
};

/// Mean over the data sets.
double relativeError(const std::vector<double>& means, const std::vector<double>& start) {
  double sum = 0;
  int count = 0;
  for (std::size_t k = 0; k < means.size(); ++k) {
    if (!std::isnan(means[k])) {
      sum += means[k] / std::max(start[k], kLeastError);
      ++count;
    }
  }
  return sum / count;
}

std::string progressLine(const std::string& label, int evaluation, int evaluations, double score,
                         double best) {
  std::array<char, 96> text{};
  std::snprintf(text.data(), text.size(),
                "%d of %d: %.2f %% of the error at the start, best %.2f %%", evaluation,
                evaluations, 100 * score, 100 * best);
  return label + text.data();
}

class Tuner {
 public:
  Tuner(const TuningRequest& request, const TuningEvents& events)
      : request_(request), events_(events), space_(request.parameters) {
    const std::vector<std::string> data_sets = dataSetsOf(request.scenes);
    const std::vector<ErrorSum> objectives = parseObjectives(request.objectives, data_sets.size());
    if (request.cross_validate) {
      requireFolds(request.scenes);
    }
    report_.start = request.start_name;
    report_.parameters = request.parameters;
    report_.rows = request.rows;
    report_.data_sets.resize(data_sets.size());
    for (const SceneReference& scene : request.scenes) {
      const auto found = std::find(data_sets.begin(), data_sets.end(), scene.data_set.name());
      const std::size_t data_set = found - data_sets.begin();
      prepare(scene, data_set, objectives[data_set]);
    }
  }

  TuningReport run() {
    Indices all(scenes_.size());
    std::iota(all.begin(), all.end(), 0);
    const Finding finding = search(all, "", [this](const Finding& found) {
      take(found);
      events_.improved(report_);
    });
    take(finding);
    if (request_.cross_validate) {
      crossValidate();
    }
    events_.improved(report_);
    return report_;
  }

 private:
  void prepare(const SceneReference& scene, std::size_t data_set, const ErrorSum& errors) {
    const std::shared_ptr<const Forest> forest = forestForScene(request_.forests, scene);
    scenes_.push_back(
        prepareScene(scene, forest, request_.start.rectification, request_.rows, held_mb_));
    held_mb_ += scenes_.back().heldMb();
    scenes_.back().data_set = data_set;
    scenes_.back().errors = errors;
    TunedDataSet& described = report_.data_sets[data_set];
    described.title = scene.data_set.title();
    described.objective = errors.name;
    described.scenes.push_back(scene.scene);
    if (std::count(report_.forests.begin(), report_.forests.end(), forest->name) == 0) {
      report_.forests.push_back(forest->name);
    }
    events_.progress("scene " + scene.scene + ", forest " + forest->name);
  }

  Finding search(const Indices& which, const std::string& label,
                 const std::function<void(const Finding&)>& improved) {
    Finding finding;
    std::vector<double> means;
    double lowest = std::numeric_limits<double>::infinity();
    const Objective objective = [&](const StereoOptions& options) {
      means = meansOf(which, options);
      if (finding.before.empty()) {
        finding.before = means;
      }
      return relativeError(means, finding.before);
    };
    const SearchProgress progress = [&](int evaluation, const SearchPoint& here,
                                        const SearchPoint& best) {
      finding.evaluations = evaluation;
      if (best.score < lowest) {
        lowest = best.score;
        finding.options = here.options;
        finding.after = means;
        improved(finding);
      }
      events_.progress(
          progressLine(label, evaluation, request_.search.evaluations, here.score, best.score));
    };
    searchParameters(space_, request_.start, objective, request_.search, progress);
    return finding;
  }

  std::vector<double> meansOf(const Indices& which, const StereoOptions& options) {
    std::vector<double> sums(report_.data_sets.size());
    std::vector<int> counts(report_.data_sets.size());
    for (const std::size_t s : which) {
      sums[scenes_[s].data_set] += scorer_.error(scenes_[s], options);
      ++counts[scenes_[s].data_set];
    }
    std::vector<double> means;
    for (std::size_t k = 0; k < sums.size(); ++k) {
      means.push_back(sums[k] / counts[k]);
    }
    return means;
  }

  void take(const Finding& found) {
    report_.options = found.options;
    report_.evaluations = found.evaluations;
    for (std::size_t k = 0; k < report_.data_sets.size(); ++k) {
      report_.data_sets[k].before = found.before[k];
      report_.data_sets[k].after = found.after[k];
    }
  }

  void crossValidate() {
    std::vector<double> sums(report_.data_sets.size());
    for (std::size_t fold = 0; fold < middleburyFolds().size(); ++fold) {
      Indices held_out;
      Indices others;
      for (std::size_t s = 0; s < scenes_.size(); ++s) {
        (foldOf(scenes_[s].scene.name) == fold ? held_out : others).push_back(s);
      }
      if (held_out.empty()) {
        continue;
      }
      const std::string label = "without fold " + std::to_string(fold + 1) + ", ";
      const Finding finding = search(others, label, [](const Finding&) {});
      report_.held_out_folds.push_back({fold, finding.options});
      events_.improved(report_);
      for (const std::size_t s : held_out) {
        sums[scenes_[s].data_set] += scorer_.error(scenes_[s], finding.options);
      }
    }
    for (std::size_t k = 0; k < sums.size(); ++k) {
      TunedDataSet& data_set = report_.data_sets[k];
      data_set.cross_validated = sums[k] / static_cast<double>(data_set.scenes.size());
    }
  }

  const TuningRequest& request_;
  const TuningEvents& events_;
  ParameterSpace space_;
  TuningReport report_;
  std::vector<TuningScene> scenes_;
  double held_mb_ = 0;  ///< memory of the prepared scenes
  TuningScorer scorer_;
};

}  // namespace

TuningReport tune(const TuningRequest& request, const TuningEvents& events) {
  const int threads = request.start.threads;
  tbb::task_arena arena(threads > 0 ? threads : static_cast<int>(tbb::task_arena::automatic));
  TuningReport report;
  arena.execute([&] { report = Tuner(request, events).run(); });
  return report;
}

}  // namespace cbmv
