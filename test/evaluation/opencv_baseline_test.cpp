#include "cbmv_stereo/evaluation/opencv_baseline.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>
#include <opencv2/calib3d.hpp>

#include "support/rendered_stereo_scene.h"

namespace cbmv {
namespace {

/// What OpenCV finds itself, negative where it finds nothing.
cv::Mat found(const StereoScene& scene) {
  cv::Mat sixteenths;
  cv::StereoSGBM::create(0, 32, 5, 200, 800, 1, 63, 10, 100, 2)
      ->compute(scene.left, scene.right, sixteenths);
  cv::Mat disparity;
  sixteenths.convertTo(disparity, CV_32F, 1.0 / 16);
  return disparity;
}

/// The nearest known disparity from x on in steps of `step`; infinity without one.
float nearest(const float* row, int width, int x, int step) {
  for (; x >= 0 && x < width; x += step) {
    if (row[x] >= 0) {
      return row[x];
    }
  }
  return INFINITY;
}

TEST(StereoSgbmSource, FillsWhatOpenCvLeavesOpen) {
  // 30 is no multiple of 16.
  const StereoScene scene = makeScene(3, {160, 96}, 30);
  const cv::Mat raw = found(scene);
  const SceneMaps maps = stereoSgbmSource()(scene);
  ASSERT_EQ(maps.disparity.size(), raw.size());
  int filled = 0;
  for (int y = 0; y < raw.rows; ++y) {
    const auto* row = raw.ptr<float>(y);
    for (int x = 0; x < raw.cols; ++x) {
      EXPECT_EQ(maps.disparity.at<float>(y, x),
                std::min(nearest(row, raw.cols, x, -1), nearest(row, raw.cols, x, 1)));
      filled += row[x] < 0 ? 1 : 0;
    }
  }
  EXPECT_GT(filled, 0);
  EXPECT_LT(filled, raw.rows * raw.cols / 2);
  EXPECT_TRUE(maps.confidence.empty());
  EXPECT_GT(maps.seconds, 0.0);
}

}  // namespace
}  // namespace cbmv
