#include "data_sets/visible_in_both.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace cbmv {
namespace {

constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();

TEST(VisibleInBoth, FollowsTheDefinitionOnRandomMaps) {
  cv::RNG rng(11);
  for (const cv::Size size : {cv::Size(61, 9), cv::Size(1, 5), cv::Size(37, 1)}) {
    cv::Mat truth(size, CV_32FC1);
    rng.fill(truth, cv::RNG::UNIFORM, -4, 12);
    truth.at<float>(0, 0) = kUnknown;
    truth.at<float>(size.height - 1, size.width - 1) = std::numeric_limits<float>::infinity();
    const cv::Mat visible = visibleInBoth(truth);
    ASSERT_EQ(visible.type(), CV_8UC1);
    for (int y = 0; y < size.height; ++y) {
      for (int x = 0; x < size.width; ++x) {
        const float d = truth.at<float>(y, x);
        const float column = static_cast<float>(x) - d;
        bool expected = std::isfinite(d) && column >= -0.5F && column <= size.width - 0.5F;
        for (int other = 0; other < size.width; ++other) {
          const float nearer = truth.at<float>(y, other);
          expected = expected && !(std::isfinite(nearer) && nearer > d + 1.0F &&
                                   std::abs(static_cast<float>(other) - nearer - column) < 1.0F);
        }
        ASSERT_EQ(visible.at<uchar>(y, x), expected ? 255 : 0) << x << ' ' << y;
      }
    }
  }
}

TEST(VisibleInBoth, AStepHidesAsManyColumnsAsItIsHigh) {
  cv::Mat truth(3, 40, CV_32FC1, cv::Scalar(2));
  truth.colRange(20, 40) = 8.0F;
  const cv::Mat visible = visibleInBoth(truth);
  for (int x = 0; x < 40; ++x) {
    EXPECT_EQ(visible.at<uchar>(1, x), x < 2 || (x >= 14 && x < 20) ? 0 : 255) << x;
  }
}

TEST(VisibleInBoth, ASlantedPlaneDoesNotHideItself) {
  cv::Mat truth(1, 60, CV_32FC1);
  for (int x = 0; x < 60; ++x) {
    truth.at<float>(0, x) = 0.45F * static_cast<float>(x);
  }
  EXPECT_EQ(cv::countNonZero(visibleInBoth(truth)), 60);
}

}  // namespace
}  // namespace cbmv
