#include "cbmv_stereo/output/points.h"

#include <cmath>

#include <gtest/gtest.h>

namespace cbmv {
namespace {

const StereoGeometry kRig{500, 0.1, -2, 500, 500, 3, 1.5};

TEST(Points, DepthAndPlaceFollowTheFormula) {
  cv::RNG random(3);
  cv::Mat_<float> disparity(4, 7);
  random.fill(disparity, cv::RNG::UNIFORM, -6.0, 20.0);
  cv::Mat_<cv::Vec3b> color(4, 7);
  random.fill(color, cv::RNG::UNIFORM, 0, 256);
  const float invalid = -1;
  disparity(1, 2) = invalid;
  disparity(3, 6) = -2;  // infinitely far
  disparity(0, 0) = 0;

  const cv::Mat valid = toValidDisparity(disparity, invalid, kRig.disparity_offset_px);
  const cv::Mat depth = toDepth(valid, kRig);
  const std::vector<ColoredPoint> points = toPoints(valid, color, kRig);
  std::size_t found = 0;
  for (int y = 0; y < 4; ++y) {
    for (int x = 0; x < 7; ++x) {
      const double d = disparity(y, x);
      if (d == invalid || d + 2 <= 0) {
        EXPECT_TRUE(std::isnan(depth.at<float>(y, x))) << x << " " << y;
        continue;
      }
      const double z = 500 * 0.1 / (d + 2);
      EXPECT_NEAR(depth.at<float>(y, x), z, 1e-6 * z);
      ASSERT_LT(found, points.size());
      const ColoredPoint& point = points[found++];
      EXPECT_NEAR(point.x, (x - 3) * z / 500, 1e-6 * z);
      EXPECT_NEAR(point.y, (y - 1.5) * z / 500, 1e-6 * z);
      EXPECT_EQ(point.z, depth.at<float>(y, x));
      EXPECT_EQ(point.r, color(y, x)[2]);
      EXPECT_EQ(point.g, color(y, x)[1]);
      EXPECT_EQ(point.b, color(y, x)[0]);
    }
  }
  EXPECT_EQ(found, points.size());
  EXPECT_GT(found, 10U);
  EXPECT_LT(found, 26U);
}

}  // namespace
}  // namespace cbmv
