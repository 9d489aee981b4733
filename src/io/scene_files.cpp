#include "scene_files.h"

#include <algorithm>

#include "cbmv_stereo/error.h"
#include "cbmv_stereo/io/disparity_file.h"
#include "cbmv_stereo/io/image_file.h"

namespace cbmv {
namespace {

std::string sizeText(const cv::Size& size) {
  return std::to_string(size.width) + "x" + std::to_string(size.height);
}

}  // namespace

void requireSameSize(const std::filesystem::path& file, const cv::Size& size,
                     const std::filesystem::path& reference, const cv::Size& expected) {
  if (size != expected) {
    throw Error("Sizes disagree: " + file.string() + " is " + sizeText(size) + ", but " +
                reference.string() + " is " + sizeText(expected) +
                "; both must have the same size.");
  }
}

void requireDisparitiesFit(const std::string& file, const StereoCalibration& calibration) {
  if (calibration.disparities > calibration.width) {
    throw Error(file + ": ndisp is " + std::to_string(calibration.disparities) +
                ", it must be at most the width of the images, " +
                std::to_string(calibration.width) + ".");
  }
}

void readPair(const std::filesystem::path& left_file, const std::filesystem::path& right_file,
              StereoScene& scene) {
  const cv::Mat left = readImage(left_file.string());
  const cv::Mat right = readImage(right_file.string());
  requireSameSize(right_file, right.size(), left_file, left.size());
  const GrayPair pair = toGrayPair(left, right);
  scene.left = pair.left;
  scene.right = pair.right;
  scene.left_color = toColor8(left);
}

cv::Mat readMatchingDisparity(const std::filesystem::path& file, double divisor,
                              const std::filesystem::path& left_file, const cv::Mat& left) {
  cv::Mat disparity = readDisparity(file.string(), divisor);
  requireSameSize(file, disparity.size(), left_file, left.size());
  return disparity;
}

StereoCalibration searchRange(const cv::Size& size, int disparities) {
  StereoCalibration calibration;
  calibration.width = size.width;
  calibration.height = size.height;
  calibration.disparities = std::min(disparities, size.width);
  return calibration;
}

std::vector<std::string> listEntries(
    const std::filesystem::path& folder,
    const std::function<bool(const std::filesystem::path&)>& accept) {
  if (!std::filesystem::is_directory(folder)) {
    throw Error("Cannot list the scenes of " + folder.string() + ": no such folder.");
  }
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (accept(entry.path())) {
      names.push_back(entry.path().filename().string());
    }
  }
  std::sort(names.begin(), names.end());
  return names;
}

}  // namespace cbmv
