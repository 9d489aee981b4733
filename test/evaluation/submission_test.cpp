#include "evaluation/submission.h"

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>

#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include "io/disparity_file.h"
#include "io/image_file.h"
#include "io/pfm.h"
#include "support/error_text.h"
#include "support/file_content.h"
#include "support/temporary_folder.h"

namespace cbmv {
namespace {

namespace fs = std::filesystem;

constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// A folder with data sets of empty files, which a writer does not read, and maps to write.
class Submission : public testing::Test {
 protected:
  Submission() {
    for (const char* name : {"v3/trainingH/Teddy/im0.png", "v3/trainingH/Teddy/calib.txt",
                             "list.txt", "v3/renamed/Teddy/im0.png", "v3/renamed/Teddy/calib.txt",
                             "testing/image_0/000003_10.png", "testing/image_2/000003_10.png"}) {
      fs::create_directories(fs::path(folder_.file(name)).parent_path());
      folder_.write(name, "a b c 1\n");
    }
    dense_.disparity = (cv::Mat_<float>(2, 3) << 0, 1.25F, 70.5F, 300, -2, 0.001F);
    dense_.seconds = 1.23456;
    sparse_ = dense_;
    sparse_.disparity = dense_.disparity.clone();
    sparse_.disparity.at<float>(0, 0) = kInfinity;
    sparse_.disparity.at<float>(1, 2) = std::numeric_limits<float>::quiet_NaN();
  }

  SubmissionWriter writer(const std::string& kind, const std::string& folder) const {
    return SubmissionWriter(DataSet::open(kind + ":" + folder_.file(folder), Truth::kOptional),
                            folder_.file("out"));
  }

  void write(const SubmissionWriter& writer, const std::string& name, const SceneMaps& maps) const {
    StereoScene scene;
    scene.name = name;
    EXPECT_FALSE(writer.has(name));
    writer.write(scene, maps);
    EXPECT_TRUE(writer.has(name));
  }

  const TemporaryFolder folder_;
  SceneMaps dense_, sparse_;
};

TEST_F(Submission, OfMiddleburyIsAFolderForEachScene) {
  const SubmissionWriter middlebury = writer("middlebury_v3", "v3/trainingH/");
  write(middlebury, "Teddy", dense_);
  write(middlebury, "Crusade", dense_);  // a test scene
  for (const std::string scene : {"trainingH/Teddy", "testH/Crusade"}) {
    const std::string base = folder_.file("out/" + scene);
    EXPECT_EQ(cv::norm(readPfm(base + "/disp0CBMV.pfm"), dense_.disparity, cv::NORM_INF), 0.0);
    EXPECT_EQ(contentOf(base + "/timeCBMV.txt"), "1.235\n");
    EXPECT_FALSE(fs::exists(base + "/disp0CBMV_s.pfm"));
  }
}

TEST_F(Submission, OfMiddleburyIsSparseWhereAPixelIsUnknown) {
  const SubmissionWriter middlebury = writer("middlebury_v3", "v3/trainingH");
  write(middlebury, "Teddy", dense_);
  StereoScene scene;
  scene.name = "Teddy";
  middlebury.write(scene, sparse_);
  EXPECT_TRUE(middlebury.has("Teddy"));
  const std::string base = folder_.file("out/trainingH/Teddy");
  EXPECT_FALSE(fs::exists(base + "/disp0CBMV.pfm"));
  const cv::Mat map = readPfm(base + "/disp0CBMV_s.pfm");
  EXPECT_EQ(map.at<float>(0, 0), kInfinity);
  EXPECT_EQ(map.at<float>(1, 2), kInfinity);
  EXPECT_EQ(map.at<float>(0, 1), 1.25F);
}

TEST_F(Submission, OfKittiHasNoZeroWhereThereIsADisparity) {
  write(writer("kitti2012", "testing"), "000003_10", sparse_);
  write(writer("kitti2015", "testing"), "000003_10", sparse_);
  for (const char* name : {"out/000003_10.png", "out/disp_0/000003_10.png"}) {
    const cv::Mat image = cv::imread(folder_.file(name), cv::IMREAD_UNCHANGED);
    const cv::Mat expected = (cv::Mat_<std::uint16_t>(2, 3) << 0, 320, 18048, 65535, 1, 0);
    ASSERT_EQ(image.type(), CV_16UC1);
    EXPECT_EQ(cv::norm(image, expected, cv::NORM_INF), 0.0) << image;
  }
  fs::remove_all(folder_.file("out"));
  write(writer("kitti2012", "testing"), "000003_10", dense_);
  const cv::Mat read = readDisparity(folder_.file("out/000003_10.png"), 256.0);
  EXPECT_EQ(read.at<float>(0, 0), 1.0F / 256.0F);
  EXPECT_EQ(read.at<float>(0, 2), 70.5F);
  EXPECT_EQ(read.at<float>(1, 2), 1.0F / 256.0F);
}

TEST_F(Submission, OfEth3dNamesTheRuntime) {
  write(writer("eth3d", "v3/renamed"), "lakeside_1l", sparse_);
  const std::string base = folder_.file("out/low_res_two_view/lakeside_1l");
  const cv::Mat map = readPfm(base + ".pfm");
  EXPECT_EQ(map.at<float>(0, 2), 70.5F);
  EXPECT_EQ(map.at<float>(1, 2), kInfinity);
  EXPECT_EQ(contentOf(base + ".txt"), "runtime 1.235\n");
}

TEST_F(Submission, NamesWhatIsWrong) {
  EXPECT_TRUE(mentions(errorText([&] { writer("list", "list.txt"); }), {"list.txt", "kitti2015"}));
  EXPECT_TRUE(mentions(errorText([&] { writer("middlebury_v3", "v3/renamed"); }),
                       {"v3/renamed", "Q, H or F"}));
  const SubmissionWriter kitti = writer("kitti2015", "testing");
  folder_.write("out", "a file where the folder should be");
  StereoScene scene;
  scene.name = "000003_10";
  EXPECT_TRUE(mentions(errorText([&] { kitti.write(scene, dense_); }), {folder_.file("out")}));
}

}  // namespace
}  // namespace cbmv
