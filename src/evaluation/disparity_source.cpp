#include "cbmv_stereo/evaluation/disparity_source.h"

#include <filesystem>
#include <limits>
#include <utility>

#include "../io/binary_file.h"
#include "../io/scene_files.h"

#include "cbmv_stereo/evaluation/folds.h"
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
  return toSceneMaps(matcher.match(scene.left, scene.right));
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
      matcher_ = std::make_unique<StereoMatcher>(
          std::make_shared<Forest>(trainWithoutFold(fold, scenes_, training_, report_)), options_);
      fold_ = fold;
    }
    return matchScene(*matcher_, scene);
  }

 private:
  std::vector<SceneReference> scenes_;
  TrainingOptions training_;
  StereoOptions options_;
  std::function<void(const std::string&)> report_;
  std::unique_ptr<StereoMatcher> matcher_;
  std::size_t fold_ = 0;
};

}  // namespace

SceneMaps toSceneMaps(const StereoResult& result) {
  SceneMaps maps{result.disparity.clone(), result.confidence, result.times.total_ms / 1000.0};
  maps.disparity.setTo(std::numeric_limits<float>::infinity(),
                       maps.disparity == result.range.invalid());
  return maps;
}

DisparitySource matchingSource(std::shared_ptr<const Forest> forest, const StereoOptions& options) {
  const auto matcher = std::make_shared<StereoMatcher>(std::move(forest), options);
  return [matcher](const StereoScene& scene) { return matchScene(*matcher, scene); };
}

DisparitySource fileSource(const std::string& folder) {
  return [folder](const StereoScene& scene) { return readMaps(folder, scene); };
}

void writeMaps(const std::string& folder, const StereoScene& scene, const SceneMaps& maps) {
  makeFolder(folder);
  const std::string base = (fs::path(folder) / scene.name).string();
  writePfm(base + ".pfm", maps.disparity);
  if (!maps.confidence.empty()) {
    writePfm(base + "_confidence.pfm", maps.confidence);
  }
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
