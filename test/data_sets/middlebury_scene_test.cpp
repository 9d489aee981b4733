#include "data_sets/middlebury_scene.h"

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "data_sets/visible_in_both.h"
#include "io/image_file.h"
#include "io/pfm.h"
#include "support/error_text.h"
#include "support/temporary_folder.h"

namespace cbmv {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// A scene of 4x2 pixels. The mask is 128 at (0, 1) and 255 elsewhere.
class MiddleburyScene : public testing::Test {
 protected:
  MiddleburyScene() {
    std::filesystem::create_directory(scene_);
    cv::Mat color(2, 4, CV_8UC3, cv::Scalar(10, 20, 30));
    cv::Mat mask(2, 4, CV_8UC1, cv::Scalar(255));
    mask.at<uchar>(0, 1) = 128;
    writeImage(scene_ + "/im0.png", color);
    writeImage(scene_ + "/im1.png", color);
    writePfm(scene_ + "/disp0GT.pfm", truth_);
    writeImage(scene_ + "/mask0nocc.png", mask);
    writeMiddleburyCalibration(scene_ + "/calib.txt", {500, 2, 2, 1, 0.1, 4, 2, 3});
  }

  const cv::Mat truth_ = (cv::Mat_<float>(2, 4) << 0, 0, kInfinity, 0, 0, 1, 0, 0);
  const TemporaryFolder folder_;
  const std::string scene_ = folder_.file("Scene");
};

TEST_F(MiddleburyScene, ReadsNamesInCapitalLetters) {
  std::filesystem::rename(scene_ + "/disp0GT.pfm", scene_ + "/disp0GT.PFM");
  EXPECT_EQ(readMiddleburyScene(scene_, 0, true).truth.at<float>(1, 1), 1.0F);
}

/// im0.png, im1.png, disp0.pfm and calib.txt with additional keys.
TEST_F(MiddleburyScene, ReadsTheDataSetsOf2014AsTheyAreDownloaded) {
  namespace fs = std::filesystem;
  fs::rename(scene_ + "/disp0GT.pfm", scene_ + "/disp0.pfm");
  fs::remove(scene_ + "/mask0nocc.png");
  folder_.write("Scene/calib.txt",
                "\xEF\xBB\xBF"
                "cam0=[500 0 2; 0 500 1; 0 0 1]\ncam1=[500 0 2; 0 500 1; 0 0 1]\ndoffs=0\n"
                "baseline=100\nwidth=4\nheight=2\nndisp=3\nisint=0\nvmin=1\nvmax=2\ndyavg=0\n"
                "dymax=0\n");
  for (const bool truth_required : {true, false}) {
    const StereoScene scene = readMiddleburyScene(scene_, 0, truth_required);
    EXPECT_EQ(scene.truth.at<float>(1, 1), 1.0F);
    EXPECT_EQ(cv::norm(scene.visible, visibleInBoth(scene.truth), cv::NORM_INF), 0.0);
    EXPECT_EQ(scene.calibration.disparities, 3);
  }
}

TEST_F(MiddleburyScene, ReadsAllParts) {
  for (const std::string& path : {scene_, scene_ + "/", scene_ + "/."}) {
    const StereoScene scene = readMiddleburyScene(path);
    EXPECT_EQ(scene.name, "Scene");
    EXPECT_EQ(scene.left.type(), CV_8UC1);
    EXPECT_EQ(scene.right.type(), CV_8UC1);
    EXPECT_EQ(scene.left.at<uchar>(1, 3), cvRound(0.114 * 10 + 0.587 * 20 + 0.299 * 30));
    EXPECT_EQ(scene.left_color.at<cv::Vec3b>(1, 3), cv::Vec3b(10, 20, 30));
    EXPECT_EQ(scene.calibration.disparities, 3);
    EXPECT_EQ(scene.truth.at<float>(1, 1), 1.0F);
    EXPECT_TRUE(std::isnan(scene.truth.at<float>(0, 2)));
    const cv::Mat visible = (cv::Mat_<uchar>(2, 4) << 255, 0, 0, 255, 255, 255, 255, 255);
    EXPECT_EQ(cv::norm(scene.visible, visible, cv::NORM_INF), 0.0);
  }
}

TEST_F(MiddleburyScene, DerivesVisibilityWithoutAMask) {
  std::filesystem::remove(scene_ + "/mask0nocc.png");
  const StereoScene scene = readMiddleburyScene(scene_);
  EXPECT_EQ(cv::norm(scene.visible, visibleInBoth(truth_), cv::NORM_INF), 0.0);
}

TEST_F(MiddleburyScene, NamesTheMissingFile) {
  for (const char* name : {"im0.png", "im1.png", "disp0GT.pfm", "calib.txt"}) {
    const std::string file = scene_ + "/" + name;
    std::filesystem::rename(file, file + ".away");
    EXPECT_TRUE(mentions(errorText([&] { readMiddleburyScene(scene_); }), {file, "no such file"}));
    std::filesystem::rename(file + ".away", file);
  }
}

TEST_F(MiddleburyScene, NamesBothFilesWhoseSizesDisagree) {
  const auto error = [&](const std::string& name) {
    std::string text = errorText([&] { readMiddleburyScene(scene_); });
    EXPECT_TRUE(mentions(text, {scene_ + "/" + name, "4x2", "4x3"}));
    return text;
  };
  writeMiddleburyCalibration(scene_ + "/calib.txt", {500, 2, 2, 1, 0.1, 4, 3, 3});
  EXPECT_TRUE(mentions(error("calib.txt"), {"im0.png"}));
  writeImage(scene_ + "/mask0nocc.png", cv::Mat::zeros(3, 4, CV_8UC1));
  EXPECT_TRUE(mentions(error("mask0nocc.png"), {"disp0GT.pfm"}));
  writePfm(scene_ + "/disp0GT.pfm", cv::Mat::zeros(3, 4, CV_32FC1));
  EXPECT_TRUE(mentions(error("disp0GT.pfm"), {"im0.png"}));
  writeImage(scene_ + "/im1.png", cv::Mat::zeros(3, 4, CV_8UC1));
  EXPECT_TRUE(mentions(error("im1.png"), {"im0.png"}));
}

TEST_F(MiddleburyScene, ListsOnlyFoldersThatHoldAScene) {
  for (const char* name : {"B", "A"}) {
    std::filesystem::copy(scene_, folder_.file(name));
  }
  std::filesystem::create_directory(folder_.file("Empty"));
  folder_.write("README.md", "");
  EXPECT_EQ(listMiddleburyScenes(folder_.file("")), (std::vector<std::string>{"A", "B", "Scene"}));
  EXPECT_TRUE(mentions(errorText([&] { listMiddleburyScenes(folder_.file("absent")); }),
                       {"absent", "no such folder"}));
}

TEST(MiddleburyData, VisibilityFromTheLeftTruthIsCloseToTheOfficialMask) {
  const char* const data = std::getenv("CBMV_DATA");
  if (data == nullptr) {
    GTEST_SKIP() << "CBMV_DATA names no data folder";
  }
  const StereoScene scene = readMiddleburyScene(std::string(data) + "/middlebury_eval3_Q/Teddy");
  const cv::Mat known = scene.truth == scene.truth;
  const cv::Mat differs = (visibleInBoth(scene.truth) != scene.visible) & known;
  EXPECT_LT(cv::countNonZero(differs), 0.03 * cv::countNonZero(known));
}

}  // namespace
}  // namespace cbmv
