#include "cbmv_stereo/training/forest_training.h"

#include <algorithm>
#include <sstream>

#include "cbmv_stereo/training/sampling.h"

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

Samples drawSamples(const std::vector<SceneReference>& scenes, const TrainingOptions& options,
                    const std::function<void(const std::string&)>& report) {
  Samples samples;
  for (std::size_t s = 0; s < scenes.size(); ++s) {
    appendSamples(preparePair(scenes[s].read(), options.rectification), options.pixels_per_scene,
                  options.seed + s, samples);
    report("sampled " + scenes[s].scene + ", " + std::to_string(samples.count()) +
           " samples so far");
  }
  return samples;
}

}  // namespace

std::string describe(const TrainingOptions& options) {
  const BoostingOptions& boosting = options.boosting;
  std::ostringstream text;
  text << "trees " << boosting.trees << ", depth " << boosting.depth << ", learning rate "
       << boosting.learning_rate << ", regularization " << boosting.regularization
       << ", pixels per scene " << options.pixels_per_scene << ", rectification refinement "
       << (options.rectification.enabled ? "on" : "off");
  if (!boosting.matchers.all()) {
    text << ", matchers";
    for (int m = 0; m < kMatcherCount; ++m) {
      text << (boosting.matchers[m] ? std::string(" ") + kMatcherNames[m] : "");
    }
  }
  return text.str();
}

Forest trainOnScenes(const std::vector<SceneReference>& scenes, const TrainingOptions& options,
                     const std::function<void(const std::string&)>& report) {
  for (const SceneReference& scene : scenes) {
    scene.read();  // refuses before hours are spent
  }
  const Samples samples = drawSamples(scenes, options, report);
  Forest forest = trainForest(samples, options.boosting, [&](int tree, double log_loss) {
    if (tree % 8 == 0 || tree == options.boosting.trees) {
      std::ostringstream line;
      line << "tree " << tree << " of " << options.boosting.trees << ", held-out log-loss "
           << log_loss;
      report(line.str());
    }
  });
  forest.provenance.program = "cbmv_train " CBMV_VERSION;
  forest.provenance.data_set = dataSetTitles(scenes);
  for (const SceneReference& scene : scenes) {
    forest.provenance.scenes.push_back(scene.scene);
  }
  forest.provenance.options = describe(options);
  forest.provenance.seed = options.seed;
  return forest;
}

}  // namespace cbmv
