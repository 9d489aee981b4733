#include "cbmv_stereo/io/image_file.h"

#include <cmath>
#include <cstdlib>
#include <string>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "support/error_text.h"
#include "support/file_content.h"
#include "support/temporary_folder.h"

namespace cbmv {
namespace {

cv::Mat randomImage(int rows, int cols, int type) {
  cv::Mat image(rows, cols, type);
  cv::RNG rng(7);
  rng.fill(image, cv::RNG::UNIFORM, 0, 256);
  return image;
}

TEST(ImageFile, ColorComesBackAsWritten) {
  const TemporaryFolder folder;
  for (const cv::Size size : {cv::Size(7, 5), cv::Size(1, 9), cv::Size(13, 1)}) {
    const cv::Mat image = randomImage(size.height, size.width, CV_8UC3);
    writeImage(folder.file("a.png"), image);
    const cv::Mat read = readColorImage(folder.file("a.png"));
    ASSERT_EQ(read.type(), CV_8UC3);
    ASSERT_EQ(read.size(), size);
    EXPECT_EQ(cv::norm(read, image, cv::NORM_INF), 0.0);
  }
}

TEST(ImageFile, GreyComesBackAsWritten) {
  const TemporaryFolder folder;
  const cv::Mat image = randomImage(5, 7, CV_8UC1);
  writeImage(folder.file("a.png"), image);
  const cv::Mat read = readGreyImage(folder.file("a.png"));
  ASSERT_EQ(read.type(), CV_8UC1);
  EXPECT_EQ(cv::norm(read, image, cv::NORM_INF), 0.0);
}

TEST(ImageFile, ColorBecomesGreyByLumaWeights) {
  const TemporaryFolder folder;
  const cv::Mat image = randomImage(31, 17, CV_8UC3);
  writeImage(folder.file("a.png"), image);
  const cv::Mat grey = readGreyImage(folder.file("a.png"));
  ASSERT_EQ(grey.type(), CV_8UC1);
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) {
      const cv::Vec3b& bgr = image.at<cv::Vec3b>(y, x);
      const double expected = 0.114 * bgr[0] + 0.587 * bgr[1] + 0.299 * bgr[2];
      ASSERT_NEAR(grey.at<uchar>(y, x), expected, 0.51);  // rounded, weights in fixed point
    }
  }
}

/// Some bytes that promise gigabytes.
TEST(ImageFile, RefusesHugeClaimsBeforeItTakesMemory) {
  const TemporaryFolder folder;
  writeImage(folder.file("small.png"), randomImage(5, 7, CV_8UC1));
  std::string png = contentOf(folder.file("small.png"));
  png.replace(16, 8, std::string("\0\0\xff\xff\0\0\xff\xff", 8));
  writeImage(folder.file("small.jpg"), randomImage(5, 7, CV_8UC1));
  std::string jpeg = contentOf(folder.file("small.jpg"));
  jpeg.replace(jpeg.find("\xff\xc0") + 5, 4, "\xff\xff\xff\xff");
  for (const std::string& content : {png, jpeg}) {
    const std::string file = folder.write("huge", content);
    EXPECT_EQ(errorText([&] { readGreyImage(file); }),
              "Cannot read " + file +
                  ": it claims to hold 4294836225 pixels, images must have at " +
                  "most 134217728.");
  }
}

TEST(ImageFile, SixteenBitsAreScaledToEight) {
  const TemporaryFolder folder;
  writeImage(folder.file("a.png"), cv::Mat(3, 4, CV_16UC1, cv::Scalar(0x8000)));
  EXPECT_NEAR(readGreyImage(folder.file("a.png")).at<uchar>(1, 1), 128, 1);
}

TEST(ImageFile, NamesTheFileThatIsNoImage) {
  const TemporaryFolder folder;
  const std::string missing = folder.file("missing.png");
  const std::string text = folder.write("text.png", "not an image");
  const std::string empty = folder.write("empty.png", "");
  const std::string truncated = folder.write("truncated.png", "\x89PNG\r\n\x1a\n");
  EXPECT_TRUE(mentions(errorText([&] { readGreyImage(missing); }), {missing, "no such file"}));
  EXPECT_TRUE(mentions(errorText([&] { readGreyImage(folder.file("")); }), {"not a file"}));
  for (const std::string& path : {text, empty, truncated}) {
    EXPECT_TRUE(mentions(errorText([&] { readGreyImage(path); }), {path, "not an image"}));
    EXPECT_TRUE(mentions(errorText([&] { readColorImage(path); }), {path}));
  }
}

TEST(ImageFile, NamesTheFileThatCannotBeWritten) {
  const TemporaryFolder folder;
  const cv::Mat image = randomImage(5, 7, CV_8UC1);
  for (const std::string& path : {folder.file("absent/a.png"), folder.file("a.unknown")}) {
    EXPECT_TRUE(mentions(errorText([&] { writeImage(path, image); }), {path}));
  }
  EXPECT_TRUE(mentions(errorText([&] { writeImage(folder.file("a.png"), cv::Mat()); }), {"a.png"}));
}

}  // namespace
}  // namespace cbmv
