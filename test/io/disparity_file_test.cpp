#include "io/disparity_file.h"

#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

#include <gtest/gtest.h>

#include "io/image_file.h"
#include "io/pfm.h"
#include "support/error_text.h"
#include "support/temporary_folder.h"

namespace cbmv {
namespace {

TEST(DisparityFile, DividesIntegersAndTakesZeroAsUnknown) {
  const TemporaryFolder folder;
  writeImage(folder.file("8.png"), (cv::Mat_<std::uint8_t>(1, 3) << 0, 1, 255));
  writeImage(folder.file("16.png"), (cv::Mat_<std::uint16_t>(1, 3) << 0, 1, 65535));
  const cv::Mat bytes = readDisparity(folder.file("8.png"), 3.0);
  const cv::Mat words = readDisparity(folder.file("16.png"), 256.0);
  ASSERT_EQ(bytes.type(), CV_32FC1);
  ASSERT_EQ(words.type(), CV_32FC1);
  EXPECT_TRUE(std::isnan(bytes.at<float>(0, 0)));
  EXPECT_FLOAT_EQ(bytes.at<float>(0, 1), 1.0F / 3.0F);
  EXPECT_FLOAT_EQ(bytes.at<float>(0, 2), 85.0F);
  EXPECT_TRUE(std::isnan(words.at<float>(0, 0)));
  EXPECT_EQ(words.at<float>(0, 1), 1.0F / 256.0F);
  EXPECT_EQ(words.at<float>(0, 2), 65535.0F / 256.0F);
}

TEST(DisparityFile, TakesFloatsThatAreNotFiniteAsUnknown) {
  const TemporaryFolder folder;
  const float infinity = std::numeric_limits<float>::infinity();
  writePfm(folder.file("d.pfm"), (cv::Mat_<float>(1, 4) << 0.0F, 3.0F, infinity, -infinity));
  const cv::Mat disparity = readDisparity(folder.file("d.pfm"), 2.0);
  EXPECT_EQ(disparity.at<float>(0, 0), 0.0F);
  EXPECT_EQ(disparity.at<float>(0, 1), 1.5F);
  EXPECT_TRUE(std::isnan(disparity.at<float>(0, 2)));
  EXPECT_TRUE(std::isnan(disparity.at<float>(0, 3)));
}

TEST(DisparityFile, ExtensionsMayBeInUpperCase) {
  const TemporaryFolder folder;
  writeImage(folder.file("d.PNG"), (cv::Mat_<std::uint16_t>(1, 1) << 512));
  writePfm(folder.file("d.PFM"), (cv::Mat_<float>(1, 1) << 2.0F));
  writePfm(folder.file("d.Pfm"), (cv::Mat_<float>(1, 1) << 2.0F));
  for (const auto& [name, divisor] : {std::pair("d.PNG", 256.0), {"d.PFM", 1.0}, {"d.Pfm", 1.0}}) {
    EXPECT_EQ(readDisparity(folder.file(name), divisor).at<float>(0, 0), 2.0F) << name;
  }
}

TEST(DisparityFile, KittiHas256LevelsAPixelAndZeroForNone) {
  const float infinity = std::numeric_limits<float>::infinity();
  const cv::Mat image =
      toKittiDisparity((cv::Mat_<float>(1, 6) << 1.5F, 0.0F, -1.0F, 300.0F, infinity, NAN));
  ASSERT_EQ(image.type(), CV_16UC1);
  EXPECT_EQ(cv::countNonZero(image != (cv::Mat_<std::uint16_t>(1, 6) << 384, 1, 1, 65535, 0, 0)),
            0);
}

TEST(DisparityFile, NamesTheFileThatIsWrong) {
  const TemporaryFolder folder;
  const auto error = [&](const std::string& path) {
    std::string text = errorText([&] { readDisparity(path, 1.0); });
    EXPECT_TRUE(mentions(text, {path}));
    return text;
  };
  EXPECT_TRUE(mentions(error(folder.file("absent.png")), {"no such file"}));
  EXPECT_TRUE(mentions(error(folder.file("absent.pfm")), {"no such file"}));
  EXPECT_TRUE(mentions(error(folder.write("text.png", "no image")), {"8 or 16 bits"}));
  EXPECT_TRUE(mentions(error(folder.write("cut.pfm", "Pf\n4 4\n-1\n1234")), {"bytes"}));
  writeImage(folder.file("color.png"), cv::Mat::zeros(2, 2, CV_8UC3));
  EXPECT_TRUE(mentions(error(folder.file("color.png")), {"gray image"}));
}

}  // namespace
}  // namespace cbmv
