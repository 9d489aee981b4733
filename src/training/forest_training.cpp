#include "cbmv_stereo/training/forest_training.h"

#include <algorithm>
#include <cstdio>
#include <sstream>

#include "cbmv_stereo/error.h"
#include "cbmv_stereo/io/middlebury_scene.h"
#include "cbmv_stereo/training/sampling.h"

namespace cbmv {
namespace {

constexpr const char* kMiddlebury = "middlebury_v3:";

bool contains(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

std::string folderOf(const std::string& data_set) {
  const std::string kind = kMiddlebury;
  if (data_set.rfind(kind, 0) != 0 || data_set.size() == kind.size()) {
    throw Error("data set " + data_set + ": must be middlebury_v3:DIR");
  }
  return data_set.substr(kind.size());
}

std::vector<std::string> chooseScenes(const std::string& folder, const TrainingOptions& options) {
  const std::vector<std::string> all = listMiddleburyScenes(folder);
  for (const std::vector<std::string>* names : {&options.scenes, &options.excluded_scenes}) {
    for (const std::string& name : *names) {
      if (!contains(all, name)) {
        throw Error("data set " + folder + ": has no scene " + name);
      }
    }
  }
  std::vector<std::string> chosen;
  for (const std::string& name : all) {
    if ((options.scenes.empty() || contains(options.scenes, name)) &&
        !contains(options.excluded_scenes, name)) {
      chosen.push_back(name);
    }
  }
  if (chosen.empty()) {
    throw Error("data set " + folder + ": no scene is left to train on");
  }
  return chosen;
}

TrainingPair preparePair(const StereoScene& scene, const RectificationOptions& options) {
  const DisparityRange range{0, scene.calibration.disparities};
  cv::Mat right = scene.right;
  if (options.enabled) {
    right = alignRightRows(right, estimateVerticalOffset(scene.left, right, range, options));
  }
  return {scene.left, right, scene.truth, scene.visible, range};
}

std::string describe(const TrainingOptions& options) {
  const BoostingOptions& boosting = options.boosting;
  std::ostringstream text;
  text << "trees " << boosting.trees << ", depth " << boosting.depth << ", learning rate "
       << boosting.learning_rate << ", regularization " << boosting.regularization
       << ", pixels per scene " << options.pixels_per_scene << ", rectification refinement "
       << (options.rectification.enabled ? "on" : "off");
  return text.str();
}

}  // namespace

Forest trainOnDataSet(const std::string& data_set, const TrainingOptions& options,
                      const std::function<void(const std::string&)>& report) {
  const std::string folder = folderOf(data_set);
  const std::vector<std::string> scenes = chooseScenes(folder, options);
  for (const std::string& scene : scenes) {
    readMiddleburyScene(folder + "/" + scene);  // refuses before hours are spent
  }
  Samples samples;
  for (std::size_t s = 0; s < scenes.size(); ++s) {
    const StereoScene scene = readMiddleburyScene(folder + "/" + scenes[s]);
    appendSamples(preparePair(scene, options.rectification), options.pixels_per_scene,
                  options.seed + s, samples);
    report("sampled " + scenes[s] + ", " + std::to_string(samples.count()) + " samples so far");
  }
  Forest forest = trainForest(samples, options.boosting, [&](int tree, double log_loss) {
    if (tree % 8 == 0 || tree == options.boosting.trees) {
      std::ostringstream line;
      line << "tree " << tree << " of " << options.boosting.trees << ", held-out log-loss "
           << log_loss;
      report(line.str());
    }
  });
  forest.provenance.program = "cbmv_train " CBMV_VERSION;
  forest.provenance.data_set = "Middlebury v3";
  forest.provenance.scenes = scenes;
  forest.provenance.options = describe(options);
  forest.provenance.seed = options.seed;
  return forest;
}

}  // namespace cbmv
