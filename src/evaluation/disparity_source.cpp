#include "evaluation/disparity_source.h"

#include <array>
#include <filesystem>
#include <limits>
#include <utility>

#include "io/binary_file.h"
#include "io/disparity_file.h"
#include "io/image_file.h"
#include "io/pfm.h"
#include "pipeline/frame_processor.h"
#include "pipeline/machine_memory.h"

#include "cbmv_stereo/stereo_matcher.h"

namespace cbmv {
namespace {

namespace fs = std::filesystem;

constexpr double kPngDivisor = 256.0;

/// Optional files of a scene.
constexpr std::array<std::pair<const char*, cv::Mat SceneMaps::*>, 2> kExtraMaps = {
    {{"_confidence.pfm", &SceneMaps::confidence}, {"_sigma.pfm", &SceneMaps::disparity_sigma}}};

SceneMaps matchScene(StereoMatcher& matcher, StereoOptions options, const StereoScene& scene) {
  options.range = options.range.isAutomatic()
                      ? rangeOfPair({scene.left, scene.right}, options.range)
                      : DisparityRange{0, scene.calibration.disparities};
  requireMemory(scene.left.size(), options);
  matcher.setOptions(options);
  return toSceneMaps(matcher.match(scene.left, scene.right));
}

/// The disparity file of a scene; SCENE.pfm if none exists.
fs::path mapFile(const fs::path& folder, const std::string& scene) {
  for (const char* extension : {".pfm", ".PFM", ".png", ".PNG"}) {
    fs::path file = folder / (scene + extension);
    if (fs::exists(file)) {
      return file;
    }
  }
  return folder / (scene + ".pfm");
}

SceneMaps readMaps(const fs::path& folder, const StereoScene& scene) {
  const fs::path file = mapFile(folder, scene.name);
  const bool is_float = isPfmName(file.string());
  SceneMaps maps;
  maps.disparity = readDisparity(file.string(), is_float ? 1.0 : kPngDivisor);
  requireSameSize(file, maps.disparity.size(), "the scene's left image", scene.left.size());
  for (const auto& [suffix, map] : kExtraMaps) {
    const fs::path extra = folder / (scene.name + suffix);
    if (fs::exists(extra)) {
      maps.*map = readPfm(extra.string());
      requireSameSize(extra, (maps.*map).size(), file, maps.disparity.size());
    }
  }
  return maps;
}

}  // namespace

SceneMaps toSceneMaps(const StereoResult& result) {
  SceneMaps maps;
  maps.disparity = result.disparity.clone();
  maps.confidence = result.confidence;
  maps.disparity_sigma = result.disparity_sigma;
  maps.seconds = result.times.total_ms / 1000.0;
  maps.disparity.setTo(std::numeric_limits<float>::infinity(),
                       maps.disparity == result.range.invalid());
  return maps;
}

DisparitySource matchingSource(std::shared_ptr<const Forest> forest, const StereoOptions& options) {
  const auto matcher = std::make_shared<StereoMatcher>(std::move(forest), options);
  return [=](const StereoScene& scene) { return matchScene(*matcher, options, scene); };
}

DisparitySource fileSource(const std::string& folder) {
  return [folder](const StereoScene& scene) { return readMaps(folder, scene); };
}

void writeMaps(const std::string& folder, const StereoScene& scene, const SceneMaps& maps) {
  makeFolder(folder);
  const std::string base = (fs::path(folder) / scene.name).string();
  writePfm(base + ".pfm", maps.disparity);
  for (const auto& [suffix, map] : kExtraMaps) {
    if (!(maps.*map).empty()) {
      writePfm(base + suffix, maps.*map);
    }
  }
}

}  // namespace cbmv
