#include "io/image_file.h"

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <utility>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "io/image_decoding.h"
#include "support/error_text.h"
#include "support/file_content.h"
#include "support/temporary_folder.h"

namespace cbmv {
namespace {

cv::Mat randomImage(int rows, int cols, int type) {
  cv::Mat image(rows, cols, type);
  cv::RNG rng(7);
  rng.fill(image, cv::RNG::UNIFORM, 0, image.depth() == CV_16U ? 1 << 16 : 256);
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

TEST(ImageFile, GrayComesBackAsWritten) {
  const TemporaryFolder folder;
  const cv::Mat image = randomImage(5, 7, CV_8UC1);
  writeImage(folder.file("a.png"), image);
  const cv::Mat read = readGrayImage(folder.file("a.png"));
  ASSERT_EQ(read.type(), CV_8UC1);
  EXPECT_EQ(cv::norm(read, image, cv::NORM_INF), 0.0);
}

TEST(ImageFile, ColorBecomesGrayByLumaWeights) {
  const TemporaryFolder folder;
  const cv::Mat image = randomImage(31, 17, CV_8UC3);
  writeImage(folder.file("a.png"), image);
  const cv::Mat gray = readGrayImage(folder.file("a.png"));
  ASSERT_EQ(gray.type(), CV_8UC1);
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) {
      const cv::Vec3b& bgr = image.at<cv::Vec3b>(y, x);
      const double expected = 0.114 * bgr[0] + 0.587 * bgr[1] + 0.299 * bgr[2];
      ASSERT_NEAR(gray.at<uchar>(y, x), expected, 0.51);  // rounded, weights in fixed point
    }
  }
}

constexpr std::uint64_t kHugePixels = 65535ULL * 65535ULL;
constexpr std::size_t kPngHeaderEnd = 24;
const std::string kJpegFrame = "\xff\xc0";

/// The bytes of a small image file with this extension.
std::string imageBytes(const std::string& ending) {
  const TemporaryFolder folder;
  writeImage(folder.file("small" + ending), randomImage(5, 7, CV_8UC1));
  return contentOf(folder.file("small" + ending));
}

/// A few bytes whose header claims gigabytes.
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

TEST(ImageFile, RejectsHugeClaimsBeforeItTakesMemory) {
  const TemporaryFolder folder;
  for (const std::string& content : {hugePng(), hugeJpeg()}) {
    const std::string file = folder.write("huge", content);
    EXPECT_EQ(errorText([&] { readGrayImage(file); }),
              "Cannot read " + file + ": its header has 4294836225 pixels, expected at " +
                  "most 134217728. Use a smaller image.");
  }
  const std::string large = folder.write("large", "");
  std::filesystem::resize_file(large, (1U << 30) + 1);
  EXPECT_TRUE(mentions(errorText([&] { readGrayImage(large); }), {"at most 1073741824"}));
}

/// OpenCV throws if its own limits are exceeded.
TEST(ImageFile, RejectsHugeClaimsOfOtherFormats) {
  const TemporaryFolder folder;
  const std::string file = folder.write("huge.pgm", "P5\n65535 65535\n255\n");
  EXPECT_TRUE(mentions(errorText([&] { readGrayImage(file); }), {file, "not an image"}));
}

/// Bytes after the end of the file must not be read.
TEST(ClaimedPixels, AreOfHeadersThatAreWhole) {
  for (const auto& [bytes, header_end] : {std::pair(hugePng(), kPngHeaderEnd),
                                          std::pair(hugeJpeg(), hugeJpeg().find(kJpegFrame) + 9)}) {
    EXPECT_EQ(claimedPixelsOf(bytes, header_end), kHugePixels);
    for (std::size_t size = 0; size < header_end; ++size) {
      EXPECT_EQ(claimedPixelsOf(bytes, size), 0U) << size;
    }
  }
}

/// A segment may contain anything, for example a thumbnail.
TEST(ClaimedPixels, AreNotOfWhatASegmentHolds) {
  const std::string segment("\xff\xe1\0\x0b\xff\xc0\0\x0b\x08\xff\xff\xff\xff", 13);
  const std::string jpeg = imageBytes(".jpg").insert(2, segment);
  EXPECT_EQ(claimedPixelsOf(jpeg, jpeg.size()), 35U);
}

TEST(ImageFile, KeepsDepthAndChannels) {
  const TemporaryFolder folder;
  for (const int type : {CV_8UC1, CV_8UC3, CV_16UC1, CV_16UC3}) {
    const cv::Mat image = randomImage(5, 7, type);
    for (const char* name : {"a.png", "a.tif"}) {
      writeImage(folder.file(name), image);
      const cv::Mat read = readImage(folder.file(name));
      ASSERT_EQ(read.type(), type) << name;
      EXPECT_EQ(cv::norm(read, image, cv::NORM_INF), 0.0) << name;
    }
  }
}

TEST(ImageFile, DropsTransparency) {
  const TemporaryFolder folder;
  for (const int depth : {CV_8U, CV_16U}) {
    const cv::Mat image = randomImage(5, 7, CV_MAKETYPE(depth, 4));
    writeImage(folder.file("a.png"), image);
    const cv::Mat read = readImage(folder.file("a.png"));
    ASSERT_EQ(read.type(), CV_MAKETYPE(depth, 3));
    for (int channel = 0; channel < 3; ++channel) {
      cv::Mat expected, found;
      cv::extractChannel(image, expected, channel);
      cv::extractChannel(read, found, channel);
      EXPECT_EQ(cv::norm(found, expected, cv::NORM_INF), 0.0);
    }
  }
}

TEST(ImageFile, PalettesBecomeColors) {
  const TemporaryFolder folder;
  constexpr std::size_t palette = 54;  // in a BMP: blue, green, red, 0 of each level
  writeImage(folder.file("a.bmp"), cv::Mat(2, 4, CV_8UC1, cv::Scalar(9)));
  std::string bytes = contentOf(folder.file("a.bmp"));
  bytes.replace(palette + 4 * 9, 3, "\x01\x02\x03");
  const cv::Mat read = readImage(folder.write("b.bmp", bytes));
  ASSERT_EQ(read.type(), CV_8UC3);
  EXPECT_EQ(read.at<cv::Vec3b>(1, 2), cv::Vec3b(1, 2, 3));
}

/// A JPEG whose EXIF data request a rotation by 90 degrees.
TEST(ImageFile, IsNotTurned) {
  const TemporaryFolder folder;
  const std::string orientation("\x01\x12\0\x03\0\0\0\x01\0\x06\0\0", 12);
  const std::string exif =
      std::string("Exif\0\0MM\0*\0\0\0\x08\0\x01", 16) + orientation + std::string(4, '\0');
  const std::string segment =
      std::string("\xff\xe1\0", 3) + static_cast<char>(exif.size() + 2) + exif;
  const std::string file = folder.write("turned.jpg", imageBytes(".jpg").insert(2, segment));
  EXPECT_EQ(readImage(file).size(), cv::Size(7, 5));
  EXPECT_EQ(readColorImage(file).size(), cv::Size(7, 5));
  EXPECT_EQ(readGrayImage(file).size(), cv::Size(7, 5));
}

TEST(ImageFile, NamesTheFileOfAnotherDepth) {
  const TemporaryFolder folder;
  writeImage(folder.file("float.tif"), cv::Mat(3, 4, CV_32FC1, cv::Scalar(0.5)));
  for (const auto& read : {readImage, readGrayImage, readColorImage}) {
    EXPECT_TRUE(mentions(errorText([&] { read(folder.file("float.tif")); }),
                         {folder.file("float.tif"), "CV_32FC1", "8 or 16 bits"}));
  }
}

/// Files with the levels 0 … `top` of one pair.
class GrayPairFiles : public testing::Test {
 protected:
  GrayPair readWithTop(int type, double top) const {
    const cv::Mat left = randomImage(40, 30, CV_MAKETYPE(CV_8U, CV_MAT_CN(type)));
    for (const auto& [name, image] : {std::pair("left.png", left), {"right.png", 255 - left}}) {
      cv::Mat scaled;
      image.convertTo(scaled, type, top / 255);
      writeImage(folder_.file(name), scaled);
    }
    return readGrayPair(folder_.file("left.png"), folder_.file("right.png"));
  }

  TemporaryFolder folder_;
};

TEST_F(GrayPairFiles, SixteenBitsAreStretched) {
  for (const int channels : {1, 3}) {
    const GrayPair expected = readWithTop(CV_8UC(channels), 255);
    const GrayPair same = readWithTop(CV_16UC(channels), 255);
    EXPECT_EQ(cv::norm(same.left, expected.left, cv::NORM_INF), 0.0);
    EXPECT_EQ(cv::norm(same.right, expected.right, cv::NORM_INF), 0.0);
    for (const double top : {1023.0, 4095.0, 65535.0}) {
      const GrayPair stretched = readWithTop(CV_16UC(channels), top);
      ASSERT_EQ(stretched.left.type(), CV_8UC1);
      double highest = 0;
      cv::minMaxLoc(stretched.left, nullptr, &highest);
      EXPECT_EQ(highest, 255) << top;
      cv::Mat correlation;
      cv::matchTemplate(stretched.right, expected.right, correlation, cv::TM_CCOEFF_NORMED);
      EXPECT_GT(correlation.at<float>(0, 0), 0.999) << top;
    }
  }
}

TEST_F(GrayPairFiles, MustHaveOneSize) {
  writeImage(folder_.file("left.png"), randomImage(5, 7, CV_8UC1));
  writeImage(folder_.file("right.png"), randomImage(5, 6, CV_8UC3));
  EXPECT_TRUE(mentions(
      errorText([&] { readGrayPair(folder_.file("left.png"), folder_.file("right.png")); }),
      {folder_.file("right.png") + " has 6x5", "7x5 as " + folder_.file("left.png")}));
}

TEST(ImageFile, NamesTheFileThatIsNoImage) {
  const TemporaryFolder folder;
  const std::string missing = folder.file("missing.png");
  const std::string text = folder.write("text.png", "not an image");
  const std::string empty = folder.write("empty.png", "");
  const std::string truncated = folder.write("truncated.png", "\x89PNG\r\n\x1a\n");
  EXPECT_TRUE(mentions(errorText([&] { readGrayImage(missing); }), {missing, "no such file"}));
  EXPECT_TRUE(mentions(errorText([&] { readGrayImage(folder.file("")); }), {"not a regular file"}));
  for (const std::string& path : {text, empty, truncated}) {
    EXPECT_TRUE(mentions(errorText([&] { readGrayImage(path); }), {path, "not an image"}));
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
