#include "evaluation/opencv_baseline.h"

#include <algorithm>
#include <chrono>
#include <iterator>
#include <limits>
#include <vector>

namespace cbmv {
namespace {

constexpr int kMultiple = 16;  // OpenCV requires multiples of 16 disparities
constexpr int kBlockPx = 5;
constexpr int kArea = kBlockPx * kBlockPx;
constexpr float kUnknown = std::numeric_limits<float>::infinity();

/// For each column, the last known value up to that column in iteration order.
template <typename In, typename Out>
void carryKnown(In begin, In end, Out out) {
  float known = kUnknown;
  for (; begin != end; ++begin, ++out) {
    known = *begin == kUnknown ? known : *begin;
    *out = known;
  }
}

void fillHoles(cv::Mat& disparity) {
  std::vector<float> from_left(disparity.cols);
  std::vector<float> from_right(disparity.cols);
  for (int y = 0; y < disparity.rows; ++y) {
    auto* row = disparity.ptr<float>(y);
    carryKnown(row, row + disparity.cols, from_left.begin());
    carryKnown(std::make_reverse_iterator(row + disparity.cols), std::make_reverse_iterator(row),
               from_right.rbegin());
    std::transform(from_left.begin(), from_left.end(), from_right.begin(), row,
                   [](float left, float right) { return std::min(left, right); });
  }
}

SceneMaps matchScene(const StereoScene& scene) {
  const auto start = std::chrono::steady_clock::now();
  cv::Mat sixteenths;
  makeStereoSgbm(scene.calibration.disparities)->compute(scene.left, scene.right, sixteenths);
  SceneMaps maps;
  sixteenths.convertTo(maps.disparity, CV_32F, 1.0 / int{cv::StereoMatcher::DISP_SCALE});
  maps.disparity.setTo(kUnknown, sixteenths < 0);
  fillHoles(maps.disparity);
  maps.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return maps;
}

}  // namespace

int openCvDisparities(int disparities) {
  return (disparities + kMultiple - 1) / kMultiple * kMultiple;
}

cv::Ptr<cv::StereoSGBM> makeStereoSgbm(int disparities, int mode) {
  return cv::StereoSGBM::create(0, openCvDisparities(disparities), kBlockPx, 8 * kArea, 32 * kArea,
                                1, 63, 10, 100, 2, mode);
}

DisparitySource stereoSgbmSource() { return matchScene; }

}  // namespace cbmv
