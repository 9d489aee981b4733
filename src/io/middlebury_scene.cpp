#include "cbmv_stereo/io/middlebury_scene.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>

#include <opencv2/imgproc.hpp>

#include "cbmv_stereo/error.h"
#include "cbmv_stereo/evaluation/disparity_error.h"
#include "cbmv_stereo/io/image_file.h"
#include "cbmv_stereo/io/pfm.h"

namespace cbmv {
namespace {

namespace fs = std::filesystem;

std::string sizeText(const cv::Size& size) {
  return std::to_string(size.width) + "x" + std::to_string(size.height);
}

void checkSize(const fs::path& file, const cv::Size& size, const fs::path& reference,
               const cv::Size& expected) {
  if (size != expected) {
    throw Error("Sizes disagree: " + file.string() + " is " + sizeText(size) + ", but " +
                reference.string() + " is " + sizeText(expected) + ".");
  }
}

void markInfinityAsUnknown(cv::Mat& truth) {
  for (auto value = truth.begin<float>(); value != truth.end<float>(); ++value) {
    if (!std::isfinite(*value)) {
      *value = std::numeric_limits<float>::quiet_NaN();
    }
  }
}

cv::Mat readVisible(const fs::path& file, const cv::Mat& truth, const fs::path& truth_file) {
  if (!fs::exists(file)) {
    return visibleInBoth(truth);
  }
  const cv::Mat mask = readGreyImage(file.string());
  checkSize(file, mask.size(), truth_file, truth.size());
  return (mask == 255) & (truth == truth);  // NaN differs from itself
}

}  // namespace

StereoScene readMiddleburyScene(const std::string& folder) {
  const fs::path base(folder);
  const fs::path left_file = base / "im0.png";
  const fs::path right_file = base / "im1.png";
  const fs::path truth_file = base / "disp0GT.pfm";
  const fs::path calibration_file = base / "calib.txt";
  StereoScene scene;
  scene.name = fs::absolute(base / ".").lexically_normal().parent_path().filename().string();
  scene.left_color = readColorImage(left_file.string());
  cv::cvtColor(scene.left_color, scene.left, cv::COLOR_BGR2GRAY);
  const cv::Size size = scene.left.size();
  scene.right = readGreyImage(right_file.string());
  checkSize(right_file, scene.right.size(), left_file, size);
  scene.truth = readPfm(truth_file.string());
  checkSize(truth_file, scene.truth.size(), left_file, size);
  markInfinityAsUnknown(scene.truth);
  scene.visible = readVisible(base / "mask0nocc.png", scene.truth, truth_file);
  scene.calibration = readMiddleburyCalibration(calibration_file.string());
  checkSize(calibration_file, {scene.calibration.width, scene.calibration.height}, left_file, size);
  return scene;
}

std::vector<std::string> listMiddleburyScenes(const std::string& folder) {
  if (!fs::is_directory(folder)) {
    throw Error("Cannot list the scenes of " + folder + ": no such folder.");
  }
  std::vector<std::string> names;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    if (fs::exists(entry.path() / "im0.png") && fs::exists(entry.path() / "calib.txt")) {
      names.push_back(entry.path().filename().string());
    }
  }
  std::sort(names.begin(), names.end());
  return names;
}

}  // namespace cbmv
