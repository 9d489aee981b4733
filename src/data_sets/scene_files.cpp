#include "data_sets/scene_files.h"

#include <algorithm>

#include "io/disparity_file.h"
#include "io/image_file.h"

#include "cbmv_stereo/error.h"

namespace cbmv {

void requireDisparitiesFit(const std::string& file, const StereoCalibration& calibration) {
  if (calibration.disparities > calibration.width) {
    throw Error(file + ": ndisp is " + std::to_string(calibration.disparities) +
                ", expected at most the width of the images, " + std::to_string(calibration.width) +
                ". Correct it.");
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
    throw Error("Cannot list the scenes of " + folder.string() +
                ": no such folder. Check the path.");
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
