#include "cbmv_stereo/training/forest_training.h"

#include <algorithm>
#include <sstream>

namespace cbmv {
namespace {

TrainingPair preparePair(const StereoScene& scene, const RectificationOptions& options) {
  const DisparityRange range{0, scene.calibration.disparities};
  cv::Mat right = scene.right;
  if (options.enabled) {
    right = alignRightRows(right, estimateVerticalOffset(scene.left, right, range, options));
  }
  return {scene.left, right, scene.truth, scene.visible, range};
}

/// Titles of the data sets, each once.
std::string dataSetTitles(const std::vector<SceneReference>& scenes) {
  std::vector<std::string> titles;
  std::string text;
  for (const SceneReference& scene : scenes) {
    const std::string& title = scene.data_set.title();
    if (std::find(titles.begin(), titles.end(), title) == titles.end()) {
      titles.push_back(title);
      text += (text.empty() ? "" : ", ") + title;
    }
  }
  return text;
}

Forest trainOblivious(const Samples& samples, const BoostingOptions& options,
                      const TrainingReport& report) {
  return trainForest(samples, options, [&](int tree, double log_loss) {
    if (tree % 8 == 0 || tree == options.trees) {
      std::ostringstream line;
      line << "tree " << tree << " of " << options.trees << ", held-out log-loss " << log_loss;
      report(line.str());
    }
  });
}

}  // namespace

std::string describe(const TrainingOptions& options) {
  std::ostringstream text;
  if (options.kind == ForestKind::kOblivious) {
    const BoostingOptions& boosting = options.boosting;
    text << "trees " << boosting.trees << ", depth " << boosting.depth << ", learning rate "
         << boosting.learning_rate << ", regularization " << boosting.regularization;
  } else {
    const RandomForestOptions& forest = options.random_forest;
    text << "random forest, trees " << forest.trees << ", samples per leaf "
         << forest.samples_per_leaf << ", features per split " << forest.features_per_split
         << ", part of the samples per tree " << forest.samples_per_tree;
  }
  text << ", pixels per scene " << options.pixels_per_scene << ", rectification refinement "
       << (options.rectification.enabled ? "on" : "off");
  return text.str();
}

Samples drawSamples(const std::vector<SceneReference>& scenes, const TrainingOptions& options,
                    const TrainingReport& report) {
  for (const SceneReference& scene : scenes) {
    scene.read();  // refuses before hours are spent
  }
  Samples samples;
  for (std::size_t s = 0; s < scenes.size(); ++s) {
    appendSamples(preparePair(scenes[s].read(), options.rectification), options.pixels_per_scene,
                  options.seed + s, samples);
    report("sampled " + scenes[s].scene + ", " + std::to_string(samples.count()) +
           " samples so far");
  }
  return samples;
}

Forest trainOnSamples(const Samples& samples, const std::vector<SceneReference>& scenes,
                      const TrainingOptions& options, const TrainingReport& report) {
  Forest forest = options.kind == ForestKind::kOblivious
                      ? trainOblivious(samples, options.boosting, report)
                      : trainRandomForest(samples, options.random_forest, options.seed);
  forest.provenance.program = "cbmv_train " CBMV_VERSION;
  forest.provenance.data_set = dataSetTitles(scenes);
  for (const SceneReference& scene : scenes) {
    forest.provenance.scenes.push_back(scene.scene);
  }
  forest.provenance.options = describe(options);
  forest.provenance.seed = options.seed;
  return forest;
}

Forest trainOnScenes(const std::vector<SceneReference>& scenes, const TrainingOptions& options,
                     const TrainingReport& report) {
  return trainOnSamples(drawSamples(scenes, options, report), scenes, options, report);
}

}  // namespace cbmv
