#include "cbmv_stereo/gray_pair.h"

#include <cstdint>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

namespace cbmv {
namespace {

/// All levels 0 … 255, equally often.
cv::Mat allLevels() {
  cv::Mat image(64, 64, CV_8UC1);
  for (int i = 0; i < 64 * 64; ++i) {
    image.at<uchar>(i / 64, i % 64) = static_cast<uchar>(i % 256);
  }
  return image;
}

bool areEqual(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && a.type() == b.type() && cv::norm(a, b, cv::NORM_INF) == 0;
}

TEST(GrayPair, SharesGrayImagesOfEightBits) {
  const cv::Mat image = allLevels();
  EXPECT_EQ(toGrayPair(image, image).left.data, image.data);
}

TEST(GrayPair, KeepsLevelsOfSixteenBitsThatFitEight) {
  const cv::Mat levels = allLevels() / 2;
  cv::Mat deep;
  levels.convertTo(deep, CV_16U);
  const GrayPair pair = toGrayPair(deep, deep);
  EXPECT_TRUE(areEqual(pair.left, levels));
  EXPECT_TRUE(areEqual(pair.right, levels));
}

TEST(GrayPair, StretchesTenTwelveAndSixteenBits) {
  for (const int bits : {10, 12, 16}) {
    cv::Mat deep;
    allLevels().convertTo(deep, CV_16U, 1 << (bits - 8));
    const GrayPair pair = toGrayPair(deep, deep);
    EXPECT_LE(cv::norm(pair.left, allLevels(), cv::NORM_INF), 1) << bits;
  }
}

TEST(GrayPair, StretchesBothImagesAlike) {
  cv::Mat deep;
  allLevels().convertTo(deep, CV_16U, 16);
  const GrayPair pair = toGrayPair(deep, deep / 2);
  EXPECT_NEAR(pair.right.at<uchar>(0, 200), pair.left.at<uchar>(0, 100), 1);
}

TEST(GrayPair, TakesTheWeightsOfColors) {
  const cv::Mat color(4, 4, CV_8UC3, cv::Scalar(10, 20, 30));
  const cv::Mat with_alpha(4, 4, CV_8UC4, cv::Scalar(10, 20, 30, 99));
  const GrayPair pair = toGrayPair(color, with_alpha);
  const int expected = cvRound(0.114 * 10 + 0.587 * 20 + 0.299 * 30);
  EXPECT_EQ(pair.left.at<uchar>(1, 1), expected);
  EXPECT_EQ(pair.right.at<uchar>(1, 1), expected);
}

TEST(Color, OfGrayAndSixteenBits) {
  EXPECT_EQ(toColor8(cv::Mat(2, 2, CV_8UC1, cv::Scalar(7))).at<cv::Vec3b>(0, 0),
            cv::Vec3b(7, 7, 7));
  cv::Mat deep;
  allLevels().convertTo(deep, CV_16U, 256);
  const cv::Mat color = toColor8(deep);
  ASSERT_EQ(color.type(), CV_8UC3);
  EXPECT_NEAR(color.at<cv::Vec3b>(1, 40)[1], allLevels().at<uchar>(1, 40), 1);
}

}  // namespace
}  // namespace cbmv
