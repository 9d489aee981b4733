#include "tuning/tuning_scene.h"

#include <algorithm>
#include <numeric>

#include "evaluation/disparity_source.h"
#include "evaluation/scene_score.h"
#include "pipeline/machine_memory.h"
#include "pipeline/memory.h"

#include "cbmv_stereo/error.h"
#include "cbmv_stereo/vertical_offset.h"

namespace cbmv {
namespace {

bool wasTrainedOn(const Forest& forest, const SceneReference& scene) {
  const ForestProvenance& provenance = forest.provenance;
  return provenance.data_set.find(scene.data_set.title()) != std::string::npos &&
         std::count(provenance.scenes.begin(), provenance.scenes.end(), scene.scene) > 0;
}

void keepMiddleRows(int rows, StereoScene& scene) {
  const int height = scene.left.rows;
  const int first = (height - rows) / 2;
  for (cv::Mat* map : {&scene.left, &scene.right, &scene.truth, &scene.visible}) {
    *map = map->rowRange(first, first + rows).clone();
  }
}

std::size_t findErrorMetric(const std::string& name) {
  std::string known;
  for (std::size_t m = 0; m < kErrorMetrics; ++m) {
    if (name == kMetrics[m].name) {
      return m;
    }
    known += (known.empty() ? "" : ", ") + std::string(kMetrics[m].name);
  }
  throw Error("objective " + name + ": unknown error, expected one of " + known);
}

}  // namespace

double ErrorSum::of(const MetricValues& values) const {
  return std::accumulate(metrics.begin(), metrics.end(), 0.0,
                         [&](double sum, std::size_t metric) { return sum + values[metric]; });
}

ErrorSum parseErrorSum(const std::string& name) {
  ErrorSum errors{name, {}};
  std::size_t begin = 0;
  std::size_t end = 0;
  do {
    end = std::min(name.find('+', begin), name.size());
    errors.metrics.push_back(findErrorMetric(name.substr(begin, end - begin)));
    begin = end + 1;
  } while (end < name.size());
  return errors;
}

std::shared_ptr<const Forest> forestForScene(
    const std::vector<std::shared_ptr<const Forest>>& forests, const SceneReference& scene) {
  for (const std::shared_ptr<const Forest>& forest : forests) {
    if (!wasTrainedOn(*forest, scene)) {
      return forest;
    }
  }
  throw Error("data set " + scene.data_set.name() + ": every given forest was trained on scene " +
              scene.scene +
              ", expected one that was not. Add such a forest with --forest, or exclude the scene");
}

TuningScene prepareScene(const SceneReference& scene, const std::shared_ptr<const Forest>& forest,
                         const RectificationOptions& rectification, int rows, double held_mb) {
  TuningScene prepared;
  prepared.forest = forest;
  StereoScene& pair = prepared.scene;
  pair = scene.read();
  pair.left_color.release();
  const DisparityRange range{0, pair.calibration.disparities};
  pair.right = alignRightRows(pair.right,
                              estimateVerticalOffset(pair.left, pair.right, range, rectification));
  if (rows > 0 && rows < pair.left.rows) {
    keepMiddleRows(rows, pair);
  }
  StereoOptions options;
  options.range = range;
  requireMachineMemory(held_mb + requiredMemoryMb(pair.left.size(), options),
                       "scene " + pair.name + " and those before it",
                       "Choose fewer scenes or fewer rows of each scene");
  return prepared;
}

double TuningScene::heldMb() const {
  const double pixels = scene.left.rows * static_cast<double>(scene.left.cols);
  constexpr double bytes_of_maps = 1 + 1 + 4 + 1;
  return pixels * bytes_of_maps / (1 << 20);
}

double TuningScorer::error(const TuningScene& scene, const StereoOptions& options) {
  StereoOptions own = options;
  own.range = {0, scene.scene.calibration.disparities};
  own.rectification.enabled = false;  // already done by prepareScene
  std::unique_ptr<StereoMatcher>& matcher = matchers_[scene.forest];
  if (matcher == nullptr) {
    matcher = std::make_unique<StereoMatcher>(scene.forest, own);
  } else {
    matcher->setOptions(own);
  }
  const StereoResult result = matcher->match(scene.scene.left, scene.scene.right);
  SceneMaps maps = toSceneMaps(result);
  maps.confidence.release();  // scoring it takes time and is not needed
  try {
    return scene.errors.of(scoreScene(scene.scene, maps).noc);
  } catch (const Error& error) {
    throw Error("scene " + scene.scene.name + ": " + error.what());
  }
}

}  // namespace cbmv
