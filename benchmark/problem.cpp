#include "problem.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>

#include <opencv2/imgproc.hpp>

#include "evaluation/rendered_scene.h"
#include "forest/forest_file.h"
#include "io/image_file.h"

#include "cbmv_stereo/error.h"
#include "cbmv_stereo/parameters.h"

namespace cbmv::benchmarks {
namespace {

/// Folder of the pair in the best available resolution; empty if there is none.
std::filesystem::path motorcycleFolder() {
  const char* data = std::getenv("CBMV_DATA");
  for (const char* resolution : {"middlebury_eval3_H", "middlebury_eval3_Q"}) {
    const auto folder = std::filesystem::path(data != nullptr ? data : "") / resolution;
    if (data != nullptr && std::filesystem::exists(folder / "Motorcycle" / "im0.png")) {
      return folder / "Motorcycle";
    }
  }
  return {};
}

cv::Mat readScaled(const std::filesystem::path& path, const Problem& problem) {
  const cv::Mat image = readGrayImage(path.string());
  const cv::Size size(problem.width, problem.height);
  cv::Mat scaled;
  cv::resize(image, scaled, size, 0, 0,
             image.cols > size.width ? cv::INTER_AREA : cv::INTER_LINEAR);
  return scaled;
}

std::string sourcePath(const std::string& path) {
  return std::string(CBMV_SOURCE_DIR) + "/" + path;
}

}  // namespace

std::string Problem::name() const {
  return std::to_string(width) + "x" + std::to_string(height) + "x" + std::to_string(disparities);
}

const std::vector<Problem>& problems() {
  static const std::vector<Problem> kProblems = {
      {320, 240, 32},  {640, 480, 64},   {640, 480, 128}, {1242, 375, 228},
      {1440, 990, 64}, {1440, 990, 256}, {941, 490, 941}};
  return kProblems;
}

Problem findProblem(const std::string& name) {
  const auto found = std::find_if(problems().begin(), problems().end(),
                                  [&](const Problem& problem) { return problem.name() == name; });
  if (found == problems().end()) {
    throw Error(name + " is not a size that is measured; it must be one such as " +
                problems().front().name());
  }
  return *found;
}

Pair loadPair(const Problem& problem) {
  const std::filesystem::path folder = motorcycleFolder();
  if (folder.empty()) {
    const RenderedScene scene = renderScene(problem.width, problem.height, 1);
    return {scene.left, scene.right};
  }
  return {readScaled(folder / "im0.png", problem), readScaled(folder / "im1.png", problem)};
}

std::string pairSource() {
  const std::filesystem::path folder = motorcycleFolder();
  return folder.empty() ? "rendered"
                        : (folder.parent_path().filename() / folder.filename()).string();
}

const std::vector<std::string>& presets() {
  static const std::vector<std::string> kPresets = {"quality", "balanced", "realtime"};
  return kPresets;
}

StereoOptions presetOptions(const std::string& preset, const Problem& problem, int threads) {
  StereoOptions options;
  readPreset(sourcePath("config/" + preset + ".yaml"), options);
  options.range = problem.range();
  options.threads = threads;
  return options;
}

std::shared_ptr<const Forest> presetForest(const std::string& preset) {
  const char* file = preset == "quality" ? "middlebury.forest" : "middlebury_small.forest";
  return loadForest(sourcePath(std::string("models/") + file));
}

}  // namespace cbmv::benchmarks
