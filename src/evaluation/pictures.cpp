#include "evaluation/pictures.h"

#include <cmath>
#include <filesystem>
#include <limits>

#include "io/binary_file.h"
#include "io/image_file.h"
#include "io/preview.h"

namespace cbmv {
namespace {

constexpr float kHighestErrorPx = 4.0F;
constexpr float kUnknown = -1.0F;

/// The highest true disparity, because the searched range is often much larger; the range if no
/// truth is known.
float highestDisparity(const StereoScene& scene) {
  double highest = 0.0;
  if (!scene.truth.empty()) {
    cv::minMaxLoc(scene.truth, nullptr, &highest, nullptr, nullptr, scene.truth == scene.truth);
  }
  return highest > 0.0 ? static_cast<float>(highest)
                       : static_cast<float>(scene.calibration.disparities - 1);
}

}  // namespace

cv::Mat errorPicture(const StereoScene& scene, const cv::Mat& disparity) {
  cv::Mat errors(scene.truth.size(), CV_32FC1, cv::Scalar(kUnknown));
  for (int y = 0; y < errors.rows; ++y) {
    for (int x = 0; x < errors.cols; ++x) {
      const float error = std::abs(disparity.at<float>(y, x) - scene.truth.at<float>(y, x));
      if (std::isfinite(scene.truth.at<float>(y, x))) {
        errors.at<float>(y, x) = std::isfinite(error) ? error : kHighestErrorPx;
      }
    }
  }
  cv::Mat picture = colorizeDisparity(errors, 0.0F, kHighestErrorPx, kUnknown);
  const cv::Mat darker = 0.5 * picture;
  darker.copyTo(picture, scene.visible == 0);
  return picture;
}

void writePictures(const std::string& folder, const StereoScene& scene, const SceneMaps& maps) {
  makeFolder(folder);
  const std::string base = (std::filesystem::path(folder) / scene.name).string();
  const auto colorize = [highest = highestDisparity(scene)](const cv::Mat& disparity) {
    return colorizeDisparity(disparity, 0.0F, highest, std::numeric_limits<float>::infinity());
  };
  writeImage(base + "_left.jpg", scene.left_color);
  writeImage(base + "_disparity.jpg", colorize(maps.disparity));
  if (!scene.truth.empty()) {
    writeImage(base + "_truth.jpg", colorize(scene.truth));
    writeImage(base + "_error.jpg", errorPicture(scene, maps.disparity));
  }
  if (!maps.confidence.empty()) {
    writeImage(base + "_confidence.jpg", colorizeConfidence(maps.confidence));
  }
}

}  // namespace cbmv
