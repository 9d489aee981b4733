#include "evaluation/rendered_poles.h"

#include <cmath>

#include <gtest/gtest.h>

namespace cbmv {
namespace {

/// Mean gray value difference between the pixels of a mask and their matches.
double meanDifference(const RenderedPoles& poles, const cv::Mat& mask, int d) {
  double sum = 0;
  int count = 0;
  for (int y = 0; y < mask.rows; ++y) {
    for (int x = d; x < mask.cols; ++x) {
      if (mask.at<std::uint8_t>(y, x) != 0) {
        sum += std::abs(poles.left.at<std::uint8_t>(y, x) - poles.right.at<std::uint8_t>(y, x - d));
        ++count;
      }
    }
  }
  return sum / count;
}

TEST(RenderedPoles, MatchAtTheirDisparity) {
  const RenderedPoles poles = renderPoles(4, 40, 1);
  for (const int width : poleWidths()) {
    const cv::Mat pole = poles.pole_width == width;
    EXPECT_EQ(cv::countNonZero(pole), 2 * width * poles.left.rows);
    EXPECT_LT(meanDifference(poles, pole, 40), 4) << width;  // noise of both images
    EXPECT_GT(meanDifference(poles, pole, 4), 20) << width;
  }
}

TEST(RenderedPoles, TheBackgroundMatchesAtItsOwn) {
  const RenderedPoles poles = renderPoles(10, 20, 2);
  cv::Mat background = poles.pole_width == 0;
  background.colRange(60, 600) = 0;  // poles occlude a part of the right image
  EXPECT_LT(meanDifference(poles, background, 10), 4);
}

TEST(RenderedPoles, RecallCountsWhatIsWithinOnePixel) {
  const RenderedPoles poles = renderPoles(4, 24, 3);
  cv::Mat disparity(poles.left.size(), CV_32FC1, cv::Scalar(24.9F));
  disparity.rowRange(0, 120) = cv::Scalar(25.1F);
  for (const int width : poleWidths()) {
    EXPECT_DOUBLE_EQ(poleRecall(poles, width, disparity), 0.75);
  }
}

TEST(RenderedPoles, TheSameSeedGivesTheSamePair) {
  const auto same = [](const cv::Mat& a, const cv::Mat& b) {
    return cv::countNonZero(a != b) == 0;
  };
  EXPECT_TRUE(same(renderPoles(4, 24, 5).right, renderPoles(4, 24, 5).right));
  EXPECT_FALSE(same(renderPoles(4, 24, 5).right, renderPoles(4, 24, 6).right));
}

}  // namespace
}  // namespace cbmv
