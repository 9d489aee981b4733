#include "training/cross_validation.h"

#include <algorithm>
#include <iterator>
#include <set>
#include <utility>

#include "cbmv_stereo/error.h"

namespace cbmv {
namespace {

std::vector<SceneReference> ofMiddlebury(const std::vector<SceneReference>& scenes) {
  std::vector<SceneReference> found;
  std::copy_if(
      scenes.begin(), scenes.end(), std::back_inserter(found),
      [](const SceneReference& scene) { return scene.data_set.kind() == "middlebury_v3"; });
  return found;
}

/// Trains the forest of a fold when the first of its scenes comes.
class FoldMatcher {
 public:
  FoldMatcher(std::vector<SceneReference> scenes, const TrainingOptions& training,
              std::vector<StereoOptions> options, TrainingReport report)
      : scenes_(std::move(scenes)),
        training_(training),
        options_(std::move(options)),
        report_(std::move(report)) {}

  SceneMaps match(const StereoScene& scene) {
    const std::size_t fold = foldOf(scene.name);
    if (source_ == nullptr || fold != fold_) {
      const StereoOptions& options = options_[options_.size() == 1 ? 0 : fold];
      training_.second.matching = {options};
      source_ = matchingSource(
          std::make_shared<Forest>(trainWithoutFold(fold, scenes_, training_, report_)), options);
      fold_ = fold;
    }
    return source_(scene);
  }

 private:
  std::vector<SceneReference> scenes_;
  TrainingOptions training_;
  std::vector<StereoOptions> options_;  ///< one, or one a fold
  TrainingReport report_;
  DisparitySource source_;
  std::size_t fold_ = 0;
};

}  // namespace

Forest trainWithoutFold(std::size_t fold, const std::vector<SceneReference>& scenes,
                        const TrainingOptions& training, const TrainingReport& report) {
  report("training the forest of fold " + std::to_string(fold + 1));
  std::vector<SceneReference> others;
  for (const SceneReference& scene : scenes) {
    if (foldOf(scene.scene) != fold) {
      others.push_back(scene);
    }
  }
  if (others.empty()) {
    throw Error("fold " + std::to_string(fold + 1) +
                ": there is no scene of another fold to train on. Add scenes of other folds");
  }
  Forest forest = trainOnScenes(others, training, report);
  forest.name = "fold " + std::to_string(fold + 1);
  return forest;
}

std::vector<std::shared_ptr<const Forest>> trainFolds(const std::vector<SceneReference>& wanted,
                                                      const std::vector<SceneReference>& pool,
                                                      const TrainingOptions& training,
                                                      const TrainingReport& report) {
  std::set<std::size_t> folds;
  for (const SceneReference& scene : ofMiddlebury(wanted)) {
    folds.insert(foldOf(scene.scene));
  }
  if (folds.empty()) {
    throw Error(
        "there is no data set of kind middlebury_v3, whose folds are needed. Add it with "
        "--dataset");
  }
  std::vector<std::shared_ptr<const Forest>> forests;
  forests.reserve(folds.size());
  for (const std::size_t fold : folds) {
    forests.push_back(
        std::make_shared<Forest>(trainWithoutFold(fold, ofMiddlebury(pool), training, report)));
  }
  return forests;
}

DisparitySource foldSource(const std::vector<SceneReference>& scenes,
                           const TrainingOptions& training,
                           const std::vector<StereoOptions>& options,
                           const TrainingReport& report) {
  if (options.size() != middleburyFolds().size() && options.size() != 1) {
    throw Error("there are " + std::to_string(options.size()) +
                " presets, expected one, or three, one for each fold. Correct --preset");
  }
  for (const SceneReference& scene : scenes) {
    foldOf(scene.scene);  // other scenes are rejected before the first training
  }
  const auto matcher = std::make_shared<FoldMatcher>(scenes, training, options, report);
  return [matcher](const StereoScene& scene) { return matcher->match(scene); };
}

}  // namespace cbmv
