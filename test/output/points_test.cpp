#include "cbmv_stereo/points.h"

#include <cmath>
#include <limits>

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
  disparity(3, 6) = -2;  // at infinity
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

TEST(Points, DepthSigmaFollowsTheFormula) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  const cv::Mat disparity = (cv::Mat_<float>(2, 4) << 10, 2.5F, kNan, 0, -1, 4, 4, 4);
  const cv::Mat sigma = (cv::Mat_<float>(2, 4) << 0.25F, 0.5F, 0.1F, 0.1F, 0.1F, kNan, 0, -1);
  const cv::Mat depth = toDepth(disparity, kRig);
  const cv::Mat depth_sigma = toDepthSigma(disparity, sigma, kRig);
  ASSERT_EQ(depth_sigma.type(), CV_32FC1);
  ASSERT_EQ(depth_sigma.size(), disparity.size());
  for (int i = 0; i < 2; ++i) {  // for a small change of disparity, to first order
    const double z = depth.at<float>(0, i);
    EXPECT_NEAR(depth_sigma.at<float>(0, i), z * z / (500 * 0.1) * sigma.at<float>(0, i), 1e-6 * z);
  }
  for (int i = 2; i < 8; ++i) {
    EXPECT_TRUE(std::isnan(depth_sigma.at<float>(i / 4, i % 4))) << i;
  }
  EXPECT_THROW(toDepthSigma(disparity, sigma.row(0), kRig), cv::Exception);
}

}  // namespace
}  // namespace cbmv
