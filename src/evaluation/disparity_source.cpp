#include "cbmv_stereo/evaluation/disparity_source.h"

#include <algorithm>
#include <filesystem>
#include <limits>
#include <utility>

#include "../io/scene_files.h"

#include "cbmv_stereo/error.h"
#include "cbmv_stereo/io/disparity_file.h"
#include "cbmv_stereo/io/pfm.h"
#include "cbmv_stereo/pipeline/stereo_matcher.h"

namespace cbmv {
namespace {

namespace fs = std::filesystem;

constexpr double kPngDivisor = 256.0;

SceneMaps matchScene(StereoMatcher& matcher, const StereoScene& scene) {
  StereoOptions options = matcher.options();
  options.range = {0, scene.calibration.disparities};
  matcher.setOptions(options);
  const StereoResult result = matcher.match(scene.left, scene.right);
  SceneMaps maps{result.disparity, result.confidence, result.times.total_ms / 1000.0};
  maps.disparity.setTo(std::numeric_limits<float>::infinity(),
                       maps.disparity == options.range.invalid());
  return maps;
}

SceneMaps readMaps(const fs::path& folder, const StereoScene& scene) {
  const fs::path float_file = folder / (scene.name + ".pfm");
  const fs::path integer_file = folder / (scene.name + ".png");
  const fs::path confidence_file = folder / (scene.name + "_confidence.pfm");
  const bool is_float = fs::exists(float_file) || !fs::exists(integer_file);
  const fs::path& file = is_float ? float_file : integer_file;
  SceneMaps maps;
  maps.disparity = readDisparity(file.string(), is_float ? 1.0 : kPngDivisor);
  requireSameSize(file, maps.disparity.size(), "the scene's left image", scene.left.size());
  if (fs::exists(confidence_file)) {
    maps.confidence = readPfm(confidence_file.string());
    requireSameSize(confidence_file, maps.confidence.size(), file, maps.disparity.size());
  }
  return maps;
}

std::size_t foldOf(const std::string& scene) {
  const std::vector<std::vector<std::string>> folds = middleburyFolds();
  for (std::size_t fold = 0; fold < folds.size(); ++fold) {
    if (std::count(folds[fold].begin(), folds[fold].end(), scene) > 0) {
      return fold;
    }
  }
  throw Error("scene " + scene + ": is in none of the three folds of Middlebury v3; exclude it");
}

/// Trains the forest of a fold when the first of its scenes comes.
class FoldMatcher {
 public:
  FoldMatcher(std::vector<SceneReference> scenes, const TrainingOptions& training,
              const StereoOptions& options, std::function<void(const std::string&)> report)
      : scenes_(std::move(scenes)),
        training_(training),
        options_(options),
        report_(std::move(report)) {}

  SceneMaps match(const StereoScene& scene) {
    const std::size_t fold = foldOf(scene.name);
    if (matcher_ == nullptr || fold != fold_) {
      matcher_ = std::make_unique<StereoMatcher>(std::make_shared<Forest>(train(fold)), options_);
      fold_ = fold;
    }
    return matchScene(*matcher_, scene);
  }

 private:
  Forest train(std::size_t fold) const {
    report_("training the forest of fold " + std::to_string(fold + 1));
    std::vector<SceneReference> others;
    for (const SceneReference& scene : scenes_) {
      if (foldOf(scene.scene) != fold) {
        others.push_back(scene);
      }
    }
    if (others.empty()) {
      throw Error("fold " + std::to_string(fold + 1) + ": no scene of another fold to train on");
    }
    return trainOnScenes(others, training_, report_);
  }

  std::vector<SceneReference> scenes_;
  TrainingOptions training_;
  StereoOptions options_;
  std::function<void(const std::string&)> report_;
  std::unique_ptr<StereoMatcher> matcher_;
  std::size_t fold_ = 0;
};

}  // namespace

DisparitySource matchingSource(std::shared_ptr<const Forest> forest, const StereoOptions& options) {
  const auto matcher = std::make_shared<StereoMatcher>(std::move(forest), options);
  return [matcher](const StereoScene& scene) { return matchScene(*matcher, scene); };
}

DisparitySource fileSource(const std::string& folder) {
  return [folder](const StereoScene& scene) { return readMaps(folder, scene); };
}

void writeMaps(const std::string& folder, const StereoScene& scene, const SceneMaps& maps) {
  fs::create_directories(folder);
  const std::string base = (fs::path(folder) / scene.name).string();
  writePfm(base + ".pfm", maps.disparity);
  if (!maps.confidence.empty()) {
    writePfm(base + "_confidence.pfm", maps.confidence);
  }
}

std::vector<std::vector<std::string>> middleburyFolds() {
  return {{"PlaytableP", "Recycle", "Shelves", "Teddy", "Vintage"},
          {"Adirondack", "ArtL", "Jadeplant", "Motorcycle", "MotorcycleE"},
          {"Piano", "PianoL", "Pipes", "Playroom", "Playtable"}};
}

std::vector<std::string> orderByFold(const std::vector<std::string>& scenes) {
  std::vector<std::pair<std::size_t, std::string>> folded;
  for (const std::string& scene : scenes) {
    folded.emplace_back(foldOf(scene), scene);
  }
  std::sort(folded.begin(), folded.end());
  std::vector<std::string> ordered;
  for (const auto& entry : folded) {
    ordered.push_back(entry.second);
  }
  return ordered;
}

DisparitySource foldSource(const std::vector<SceneReference>& scenes,
                           const TrainingOptions& training, const StereoOptions& options,
                           const std::function<void(const std::string&)>& report) {
  for (const SceneReference& scene : scenes) {
    foldOf(scene.scene);  // refuses before the first training
  }
  const auto matcher = std::make_shared<FoldMatcher>(scenes, training, options, report);
  return [matcher](const StereoScene& scene) { return matcher->match(scene); };
}

}  // namespace cbmv
