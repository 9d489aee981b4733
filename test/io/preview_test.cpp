#include "io/preview.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

namespace cbmv {
namespace {

cv::Vec3b color(int level, int map) {
  cv::Mat picture;
  cv::applyColorMap(cv::Mat(1, 1, CV_8UC1, cv::Scalar(level)), picture, map);
  return picture.at<cv::Vec3b>(0, 0);
}

TEST(Preview, DisparityRunsThroughTheColorMap) {
  const float lowest = -3.0F;
  const float highest = 17.0F;
  cv::Mat disparity(7, 31, CV_32FC1);
  cv::RNG(5).fill(disparity, cv::RNG::UNIFORM, -10, 25);
  const cv::Mat picture = colorizeDisparity(disparity, lowest, highest, -20.0F);
  ASSERT_EQ(picture.type(), CV_8UC3);
  for (int y = 0; y < disparity.rows; ++y) {
    for (int x = 0; x < disparity.cols; ++x) {
      const double position = (disparity.at<float>(y, x) - lowest) / (highest - lowest);
      const double exact = 255.0 * std::clamp(position, 0.0, 1.0);
      if (std::abs(exact - std::floor(exact) - 0.5) < 1e-3) {
        continue;  // either neighbor is correct
      }
      ASSERT_EQ(picture.at<cv::Vec3b>(y, x), color(cvRound(exact), cv::COLORMAP_TURBO));
    }
  }
}

TEST(Preview, PixelsWithoutADisparityAreBlack) {
  const float infinity = std::numeric_limits<float>::infinity();
  const cv::Mat disparity = (cv::Mat_<float>(1, 5) << -1, NAN, infinity, 0, 4);
  const cv::Mat picture = colorizeDisparity(disparity, 0.0F, 4.0F, -1.0F);
  const cv::Vec3b black(0, 0, 0);
  EXPECT_EQ(picture.at<cv::Vec3b>(0, 0), black);
  EXPECT_EQ(picture.at<cv::Vec3b>(0, 1), black);
  EXPECT_EQ(picture.at<cv::Vec3b>(0, 2), black);
  EXPECT_EQ(picture.at<cv::Vec3b>(0, 3), color(0, cv::COLORMAP_TURBO));
  EXPECT_EQ(picture.at<cv::Vec3b>(0, 4), color(255, cv::COLORMAP_TURBO));
}

TEST(Preview, AnEmptyRangeShowsTheLowestColor) {
  const cv::Mat disparity = (cv::Mat_<float>(1, 3) << 1, 2, 3);
  const cv::Mat picture = colorizeDisparity(disparity, 2.0F, 2.0F, -1.0F);
  for (int x = 0; x < 3; ++x) {
    EXPECT_EQ(picture.at<cv::Vec3b>(0, x), color(0, cv::COLORMAP_TURBO));
  }
}

TEST(Preview, ConfidenceIsClamped) {
  const cv::Mat confidence = (cv::Mat_<float>(1, 6) << -1, 0, 0.5, 1, 2, NAN);
  const cv::Mat picture = colorizeConfidence(confidence);
  const std::vector<int> levels = {0, 0, 128, 255, 255, 0};
  for (int x = 0; x < 6; ++x) {
    EXPECT_EQ(picture.at<cv::Vec3b>(0, x), color(levels[x], cv::COLORMAP_VIRIDIS)) << x;
  }
}

}  // namespace
}  // namespace cbmv
