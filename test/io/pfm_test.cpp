#include "io/pfm.h"

#include <cmath>
#include <cstring>
#include <limits>
#include <string>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "support/error_text.h"
#include "support/file_content.h"
#include "support/temporary_folder.h"

namespace cbmv {
namespace {

/// 3 columns, 2 rows; bottom row 1 2 3, top row 4 5 infinity, big endian.
std::string bigEndianValues() {
  return {
      "\x3f\x80\x00\x00\x40\x00\x00\x00\x40\x40\x00\x00"
      "\x40\x80\x00\x00\x40\xa0\x00\x00\x7f\x80\x00\x00",
      24};
}

std::string littleEndianValues() {
  std::string values = bigEndianValues();
  for (std::size_t i = 0; i < values.size(); i += 4) {
    std::swap(values[i], values[i + 3]);
    std::swap(values[i + 1], values[i + 2]);
  }
  return values;
}

TEST(Pfm, ReadsBothByteOrdersFromTheBottomUp) {
  const TemporaryFolder folder;
  const cv::Mat expected =
      (cv::Mat_<float>(2, 3) << 4, 5, std::numeric_limits<float>::infinity(), 1, 2, 3);
  for (const std::string& content :
       {"Pf\n3 2\n1.0\n" + bigEndianValues(), "Pf\n3 2\n-0.003922\n" + littleEndianValues(),
        "Pf 3\n2\n-1\n" + littleEndianValues()}) {
    const cv::Mat map = readPfm(folder.write("a.pfm", content));
    ASSERT_EQ(map.type(), CV_32FC1);
    ASSERT_EQ(map.size(), expected.size());
    for (int i = 0; i < 6; ++i) {
      EXPECT_EQ(map.at<float>(i / 3, i % 3), expected.at<float>(i / 3, i % 3));
    }
  }
}

TEST(Pfm, HeadersMayHaveCommentsBlanksAndLineEndsOfWindows) {
  const TemporaryFolder folder;
  for (const char* header : {"Pf\r\n3 2\r\n-1.0\r\n", "Pf\n# by a program\n# 9 9\n3 2\n-1\n",
                             "Pf # map\r\n3 # columns\r\n2\r\n# scale\r\n-1\r\n", "Pf\r3 2\r-1\r",
                             "Pf \n3 2 \n-1.0 \n", "Pf\n3 2\n-1.0 \r\n"}) {
    const cv::Mat map = readPfm(folder.write("a.pfm", header + littleEndianValues()));
    ASSERT_EQ(map.size(), cv::Size(3, 2));
    EXPECT_EQ(map.at<float>(1, 0), 1) << header;
    EXPECT_EQ(map.at<float>(0, 1), 5) << header;
  }
}

/// A value whose first byte is a line feed does not belong to the header.
TEST(Pfm, TheSizeTellsWhereTheHeaderEnds) {
  const TemporaryFolder folder;
  const std::string value("\n\x00\x80\x3f", 4);
  for (const char* end : {"\r", "\r\n", "\n", " \n"}) {
    const cv::Mat map = readPfm(folder.write("a.pfm", std::string("Pf\n1 1\n-1") + end + value));
    EXPECT_EQ(std::memcmp(map.data, value.data(), 4), 0);
  }
}

TEST(Pfm, ValuesComeBackBitForBit) {
  const TemporaryFolder folder;
  for (const cv::Size size : {cv::Size(5, 3), cv::Size(1, 7), cv::Size(9, 1), cv::Size(1, 1)}) {
    cv::Mat wide(size.height, size.width + 4, CV_32FC1);
    cv::RNG(3).fill(wide, cv::RNG::UNIFORM, -1e6, 1e6);
    cv::Mat map = wide.colRange(2, 2 + size.width);  // rows that are not adjacent in memory
    map.at<float>(0, 0) = std::numeric_limits<float>::infinity();
    writePfm(folder.file("a.pfm"), map);
    const cv::Mat read = readPfm(folder.file("a.pfm"));
    ASSERT_EQ(read.size(), size);
    for (int y = 0; y < size.height; ++y) {
      EXPECT_EQ(std::memcmp(read.ptr(y), map.ptr(y), 4 * static_cast<std::size_t>(size.width)), 0);
    }
  }
}

TEST(Pfm, WritesLittleEndian) {
  const TemporaryFolder folder;
  writePfm(folder.file("a.pfm"), cv::Mat(1, 1, CV_32FC1, cv::Scalar(1.0)));
  EXPECT_EQ(contentOf(folder.file("a.pfm")), std::string("Pf\n1 1\n-1.0\n\x00\x00\x80\x3f", 16));
}

TEST(Pfm, SaysWhatIsWrongWithTheFile) {
  const TemporaryFolder folder;
  const auto error = [&](const std::string& content) {
    const std::string path = folder.write("bad.pfm", content);
    std::string text = errorText([&] { readPfm(path); });
    EXPECT_TRUE(mentions(text, {path}));
    return text;
  };
  const std::string values = littleEndianValues();
  EXPECT_TRUE(mentions(error(""), {"not a gray PFM file"}));
  EXPECT_TRUE(mentions(error("PF\n3 2\n-1\n" + values), {"not a gray PFM file"}));
  EXPECT_TRUE(mentions(error("P5\n3 2\n255\n" + values), {"not a gray PFM file"}));
  EXPECT_TRUE(mentions(error("Pf\nthree 2\n-1\n" + values), {"header"}));
  EXPECT_TRUE(mentions(error("Pf\n3 2\n0\n" + values), {"header"}));
  EXPECT_TRUE(mentions(error("Pf\n3 2"), {"header"}));
  EXPECT_TRUE(mentions(error("Pf\n99999999999999999999 2\n-1\n"), {"header"}));
  EXPECT_TRUE(mentions(error("Pf\n65536 1\n-1\n" + values), {"65536x1", "1 to 65535"}));
  EXPECT_TRUE(mentions(error("Pf\n1 65536\n-1\n" + values), {"1x65536", "1 to 65535"}));
  EXPECT_TRUE(mentions(error("Pf\n0 2\n-1\n" + values), {"0x2"}));
  EXPECT_TRUE(mentions(error("Pf\n-3 -2\n-1\n" + values), {"-3x-2"}));
  EXPECT_TRUE(mentions(error("Pf\n65535 65535\n-1\n" + values), {"has 42 bytes", "17179344918"}));
  EXPECT_TRUE(
      mentions(error("Pf\n3 2\n-1\n" + values.substr(1)), {"has 33 bytes", "expected 34 for"}));
  EXPECT_TRUE(mentions(error("Pf\n3 2\n-1\n" + values + "x"), {"has 35 bytes"}));
}

TEST(Pfm, NamesTheFileThatCannotBeOpened) {
  const TemporaryFolder folder;
  const std::string missing = folder.file("missing.pfm");
  EXPECT_TRUE(mentions(errorText([&] { readPfm(missing); }), {missing, "no such file"}));
  const std::string unwritable = folder.file("absent/a.pfm");
  EXPECT_TRUE(mentions(errorText([&] { writePfm(unwritable, cv::Mat::zeros(1, 1, CV_32FC1)); }),
                       {unwritable}));
}

}  // namespace
}  // namespace cbmv
