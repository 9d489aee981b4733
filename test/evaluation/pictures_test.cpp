#include "evaluation/pictures.h"

#include <limits>
#include <string>

#include <gtest/gtest.h>

#include "io/image_file.h"
#include "io/preview.h"
#include "support/error_text.h"
#include "support/temporary_folder.h"

namespace cbmv {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

/// One row: correct, 2 px off, 4 px off, 9 px off, none, 2 px off but occluded, unknown truth.
StereoScene makeScene() {
  StereoScene scene;
  scene.name = "Scene";
  scene.left_color = cv::Mat(1, 7, CV_8UC3, cv::Scalar(10, 20, 30));
  scene.truth = (cv::Mat_<float>(1, 7) << 9, 9, 9, 9, 9, 9, kNan);
  scene.visible = (cv::Mat_<uchar>(1, 7) << 255, 255, 255, 255, 255, 0, 0);
  scene.calibration.disparities = 20;
  return scene;
}

SceneMaps makeMaps() {
  SceneMaps maps;
  maps.disparity = (cv::Mat_<float>(1, 7) << 9, 11, 5, 18, kInfinity, 11, 9);
  return maps;
}

TEST(ErrorPicture, ColorsErrorsUpToFourPixels) {
  const cv::Mat picture = errorPicture(makeScene(), makeMaps().disparity);
  const cv::Mat colors =
      colorizeDisparity((cv::Mat_<float>(1, 3) << 0.0F, 2.0F, 4.0F), 0.0F, 4.0F, -1.0F);
  const auto at = [&](int x) { return picture.at<cv::Vec3b>(0, x); };
  EXPECT_EQ(at(0), colors.at<cv::Vec3b>(0, 0));
  EXPECT_EQ(at(1), colors.at<cv::Vec3b>(0, 1));
  for (const int x : {2, 3, 4}) {
    EXPECT_EQ(at(x), colors.at<cv::Vec3b>(0, 2)) << x;
  }
  for (int c = 0; c < 3; ++c) {
    EXPECT_NEAR(at(5)[c], at(1)[c] / 2.0, 0.5);
  }
  EXPECT_EQ(at(6), cv::Vec3b(0, 0, 0));
}

TEST(Pictures, ColorsReachToTheHighestTrueDisparity) {
  const TemporaryFolder folder;
  StereoScene scene = makeScene();
  scene.left_color = cv::Mat(16, 16, CV_8UC3, cv::Scalar(0));
  scene.truth = cv::Mat(16, 16, CV_32FC1, cv::Scalar(9));
  scene.truth.at<float>(0, 0) = kNan;
  scene.visible = cv::Mat(16, 16, CV_8UC1, cv::Scalar(255));
  SceneMaps maps;
  maps.disparity = cv::Mat(16, 16, CV_32FC1, cv::Scalar(9));
  const auto expect_color = [&](float highest) {
    writePictures(folder.file(""), scene, maps);
    const cv::Vec3b color = readColorImage(folder.file("Scene_disparity.jpg")).at<cv::Vec3b>(8, 8);
    const cv::Mat expected = colorizeDisparity(maps.disparity, 0.0F, highest, kInfinity);
    for (int c = 0; c < 3; ++c) {
      EXPECT_NEAR(color[c], expected.at<cv::Vec3b>(8, 8)[c], 8) << highest;  // JPEG rounds
    }
  };
  expect_color(9.0F);
  scene.truth.setTo(kNan);
  expect_color(19.0F);
}

TEST(Pictures, WithoutTruthAreOfTheMapsAlone) {
  const TemporaryFolder folder;
  StereoScene scene = makeScene();
  scene.truth.release();
  scene.visible.release();
  writePictures(folder.file(""), scene, makeMaps());
  EXPECT_EQ(readColorImage(folder.file("Scene_disparity.jpg")).size(), cv::Size(7, 1));
  EXPECT_THROW(readColorImage(folder.file("Scene_truth.jpg")), Error);
  EXPECT_THROW(readColorImage(folder.file("Scene_error.jpg")), Error);
}

TEST(Pictures, AreWrittenForEachMap) {
  const TemporaryFolder folder;
  SceneMaps maps = makeMaps();
  writePictures(folder.file("maps"), makeScene(), maps);
  const std::string base = folder.file("maps/Scene_");
  for (const char* name : {"left", "truth", "disparity", "error"}) {
    EXPECT_EQ(readColorImage(base + name + ".jpg").size(), cv::Size(7, 1)) << name;
  }
  EXPECT_THROW(readColorImage(base + "confidence.jpg"), Error);
  maps.confidence = cv::Mat::ones(1, 7, CV_32FC1);
  writePictures(folder.file("maps"), makeScene(), maps);
  EXPECT_EQ(readColorImage(base + "confidence.jpg").size(), cv::Size(7, 1));
}

}  // namespace
}  // namespace cbmv
