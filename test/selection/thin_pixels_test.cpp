#include "selection/thin_pixels.h"

#include <cstdint>

#include <gtest/gtest.h>

namespace cbmv {
namespace {

constexpr int kFar = 80;    ///< 10 px, in units of the map
constexpr int kNear = 240;  ///< 30 px

cv::Mat background() { return cv::Mat(60, 80, CV_16SC1, cv::Scalar(kFar)); }

/// Pixels of a line of `width` columns (`direction.y` not 0) through the middle of the map.
cv::Mat withLine(const cv::Point& direction, int width, int half_length) {
  cv::Mat map = background();
  for (int step = -half_length; step <= half_length; ++step) {
    const cv::Point pixel = cv::Point(40, 30) + step * direction;
    map(cv::Rect(pixel.x, pixel.y, width, 1)).setTo(kNear);
  }
  return map;
}

TEST(ThinPixel, IsAPoleOfUpTo4Pixels) {
  for (int width = 1; width <= 4; ++width) {
    EXPECT_TRUE(isThin(withLine({0, 1}, width, 20), 30, 40)) << width;
  }
  EXPECT_FALSE(isThin(withLine({0, 1}, 5, 20), 30, 40));
}

TEST(ThinPixel, MayLieOrLean) {
  EXPECT_TRUE(isThin(withLine({0, 1}, 2, 20).t(), 40, 30));
  EXPECT_TRUE(isThin(withLine({1, 1}, 2, 20), 30, 40));
  EXPECT_TRUE(isThin(withLine({-1, 1}, 2, 20), 30, 40));
}

TEST(ThinPixel, IsLongerThanSevenPixels) {
  EXPECT_FALSE(isThin(withLine({0, 1}, 1, 3), 30, 40));  // 7 px
  EXPECT_TRUE(isThin(withLine({0, 1}, 1, 4), 30, 40));   // 9 px
}

TEST(ThinPixel, MayHaveGapsAndVaryBy1Px) {
  cv::Mat map = withLine({0, 1}, 2, 20);
  for (int y = 0; y < map.rows; y += 2) {
    map.row(y).setTo(kFar);  // including row 30
  }
  EXPECT_TRUE(isThin(map, 31, 40));
  map.col(40).rowRange(20, 31) += 8;
  EXPECT_TRUE(isThin(map, 31, 40));
  map.col(40) += 9;
  map.at<std::int16_t>(31, 40) = kNear;
  EXPECT_FALSE(isThin(map, 31, 40));
}

TEST(ThinPixel, EndsAtTheBorderOfTheImage) {
  cv::Mat map = background();
  map.col(0).setTo(kNear);
  map.col(79).setTo(kNear);
  EXPECT_TRUE(isThin(map, 0, 0));
  EXPECT_TRUE(isThin(map, 59, 79));
  EXPECT_FALSE(isThin(map, 30, 2));
}

TEST(ThinPixel, IsNoSurface) { EXPECT_FALSE(isThin(background(), 30, 40)); }

}  // namespace
}  // namespace cbmv
