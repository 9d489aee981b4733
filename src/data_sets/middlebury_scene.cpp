#include "data_sets/middlebury_scene.h"

#include <filesystem>

#include "data_sets/scene_files.h"
#include "data_sets/visible_in_both.h"
#include "io/image_file.h"

namespace cbmv {
namespace {

namespace fs = std::filesystem;

cv::Mat readVisible(const fs::path& file, const cv::Mat& truth, const fs::path& truth_file) {
  if (!fs::exists(file)) {
    return visibleInBoth(truth);
  }
  const cv::Mat mask = readGrayImage(file.string());
  requireSameSize(file, mask.size(), truth_file, truth.size());
  return (mask == 255) & (truth == truth);  // NaN differs from itself
}

/// disp0GT.pfm (evaluation data) or disp0.pfm (2014 data sets); disp0GT.pfm if neither exists.
fs::path truthFile(const fs::path& folder) {
  for (const char* name : {"disp0GT.pfm", "disp0.pfm", "disp0GT.PFM", "disp0.PFM"}) {
    if (fs::exists(folder / name)) {
      return folder / name;
    }
  }
  return folder / "disp0GT.pfm";
}

}  // namespace

StereoScene readMiddleburyScene(const std::string& folder, int default_disparities,
                                bool truth_required) {
  const fs::path base(folder);
  const fs::path left_file = base / "im0.png";
  const fs::path truth_file = truthFile(base);
  const fs::path calibration_file = base / "calib.txt";
  StereoScene scene;
  scene.name = fs::absolute(base / ".").lexically_normal().parent_path().filename().string();
  readPair(left_file, base / "im1.png", scene);
  if (truth_required || fs::exists(truth_file)) {
    scene.truth = readMatchingDisparity(truth_file, 1.0, left_file, scene.left);
    scene.visible = readVisible(base / "mask0nocc.png", scene.truth, truth_file);
  }
  scene.calibration = readMiddleburyCalibration(calibration_file.string(), default_disparities);
  requireSameSize(calibration_file, {scene.calibration.width, scene.calibration.height}, left_file,
                  scene.left.size());
  requireDisparitiesFit(calibration_file.string(), scene.calibration);
  return scene;
}

std::vector<std::string> listMiddleburyScenes(const std::string& folder) {
  return listEntries(folder, [](const fs::path& entry) {
    return fs::exists(entry / "im0.png") && fs::exists(entry / "calib.txt");
  });
}

}  // namespace cbmv
