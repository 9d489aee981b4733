#include "evaluation/opencv_baseline.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>
#include <opencv2/calib3d.hpp>

#include "support/rendered_stereo_scene.h"

namespace cbmv {
namespace {

/// Disparities of OpenCV; negative where it finds none.
cv::Mat found(const StereoScene& scene) {
  cv::Mat sixteenths;
  cv::StereoSGBM::create(0, 32, 5, 200, 800, 1, 63, 10, 100, 2)
      ->compute(scene.left, scene.right, sixteenths);
  cv::Mat disparity;
  sixteenths.convertTo(disparity, CV_32F, 1.0 / 16);
  return disparity;
}

/// The nearest known disparity from x in steps of `step`; infinity if there is none.
float nearest(const float* row, int width, int x, int step) {
  for (; x >= 0 && x < width; x += step) {
    if (row[x] >= 0) {
      return row[x];
    }
  }
  return INFINITY;
}

TEST(OpenCvDisparities, AreTheNextMultipleOfSixteen) {
  EXPECT_EQ(openCvDisparities(1), 16);
  EXPECT_EQ(openCvDisparities(16), 16);
  EXPECT_EQ(openCvDisparities(17), 32);
  EXPECT_EQ(openCvDisparities(228), 240);
}

TEST(MakeStereoSgbm, HasTheSettingsOfTheHeader) {
  const auto matcher = makeStereoSgbm(228, cv::StereoSGBM::MODE_HH);
  EXPECT_EQ(matcher->getMinDisparity(), 0);
  EXPECT_EQ(matcher->getNumDisparities(), 240);
  EXPECT_EQ(matcher->getBlockSize(), 5);
  EXPECT_EQ(matcher->getP1(), 200);
  EXPECT_EQ(matcher->getP2(), 800);
  EXPECT_EQ(matcher->getDisp12MaxDiff(), 1);
  EXPECT_EQ(matcher->getPreFilterCap(), 63);
  EXPECT_EQ(matcher->getUniquenessRatio(), 10);
  EXPECT_EQ(matcher->getSpeckleWindowSize(), 100);
  EXPECT_EQ(matcher->getSpeckleRange(), 2);
  EXPECT_EQ(matcher->getMode(), cv::StereoSGBM::MODE_HH);
  EXPECT_EQ(makeStereoSgbm(30)->getMode(), cv::StereoSGBM::MODE_SGBM);
}

TEST(StereoSgbmSource, FillsWhatOpenCvLeavesOpen) {
  // 30 is not a multiple of 16.
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
