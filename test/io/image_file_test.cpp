#include "cbmv_stereo/io/image_file.h"

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <utility>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "../src/io/image_size.h"
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

constexpr std::uint64_t kHugePixels = 65535ULL * 65535ULL;
constexpr std::size_t kPngHeaderEnd = 24;
const std::string kJpegFrame = "\xff\xc0";

/// The bytes of a small image with the ending.
std::string imageBytes(const std::string& ending) {
  const TemporaryFolder folder;
  writeImage(folder.file("small" + ending), randomImage(5, 7, CV_8UC1));
  return contentOf(folder.file("small" + ending));
}

/// Some bytes that promise gigabytes.
std::string hugePng() {
  return imageBytes(".png").replace(16, 8, std::string("\0\0\xff\xff\0\0\xff\xff", 8));
}

std::string hugeJpeg() {
  std::string jpeg = imageBytes(".jpg");
  return jpeg.replace(jpeg.find(kJpegFrame) + 5, 4, "\xff\xff\xff\xff");
}

std::uint64_t claimedPixelsOf(const std::string& bytes, std::size_t size) {
  return claimedPixels(reinterpret_cast<const std::uint8_t*>(bytes.data()), size);
}

TEST(ImageFile, RefusesHugeClaimsBeforeItTakesMemory) {
  const TemporaryFolder folder;
  for (const std::string& content : {hugePng(), hugeJpeg()}) {
    const std::string file = folder.write("huge", content);
    EXPECT_EQ(errorText([&] { readGreyImage(file); }),
              "Cannot read " + file +
                  ": it claims to hold 4294836225 pixels, images must have at " +
                  "most 134217728.");
  }
  const std::string large = folder.write("large", "");
  std::filesystem::resize_file(large, (1U << 30) + 1);
  EXPECT_TRUE(mentions(errorText([&] { readGreyImage(large); }), {"at most 1073741824"}));
}

/// OpenCV throws where its own limits are exceeded.
TEST(ImageFile, RefusesHugeClaimsOfOtherFormats) {
  const TemporaryFolder folder;
  const std::string file = folder.write("huge.pgm", "P5\n65535 65535\n255\n");
  EXPECT_TRUE(mentions(errorText([&] { readGreyImage(file); }), {file, "not an image"}));
}

/// What lies behind the end of a file is none of its bytes.
TEST(ClaimedPixels, AreOfHeadersThatAreWhole) {
  for (const auto& [bytes, header_end] : {std::pair(hugePng(), kPngHeaderEnd),
                                          std::pair(hugeJpeg(), hugeJpeg().find(kJpegFrame) + 9)}) {
    EXPECT_EQ(claimedPixelsOf(bytes, header_end), kHugePixels);
    for (std::size_t size = 0; size < header_end; ++size) {
      EXPECT_EQ(claimedPixelsOf(bytes, size), 0U) << size;
    }
  }
}

/// A segment may hold anything, a picture of the picture for one.
TEST(ClaimedPixels, AreNotOfWhatASegmentHolds) {
  const std::string segment("\xff\xe1\0\x0b\xff\xc0\0\x0b\x08\xff\xff\xff\xff", 13);
  const std::string jpeg = imageBytes(".jpg").insert(2, segment);
  EXPECT_EQ(claimedPixelsOf(jpeg, jpeg.size()), 35U);
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
