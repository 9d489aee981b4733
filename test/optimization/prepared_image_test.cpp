#include "optimization/prepared_image.h"

#include <cmath>

#include <gtest/gtest.h>

#include "support/random_images.h"

namespace cbmv::test {
namespace {

/// Standard deviation: root of the mean squared distance to the mean.
double naiveDeviation(const cv::Mat& gray) {
  double mean = 0;
  for (const auto value : cv::Mat_<std::uint8_t>(gray)) {
    mean += value / static_cast<double>(gray.total());
  }
  double variance = 0;
  for (const auto value : cv::Mat_<std::uint8_t>(gray)) {
    variance += (value - mean) * (value - mean) / static_cast<double>(gray.total());
  }
  return std::sqrt(variance);
}

TEST(GrayDeviation, EqualsTheFormula) {
  for (const Shape& shape : awkwardShapes()) {
    for (const Content content : {Content::kNoise, Content::kPatches}) {
      const cv::Mat gray = makeGray(shape.size(), content, 1);
      const double expected = naiveDeviation(gray);
      EXPECT_NEAR(grayDeviation(gray), expected, 1e-6 * expected) << shape << ", " << content;
    }
  }
}

TEST(GrayDeviation, OfOneGrayIsZero) {
  EXPECT_EQ(grayDeviation(cv::Mat(1, 1, CV_8UC1, cv::Scalar(200))), 0.0F);
  EXPECT_EQ(grayDeviation(cv::Mat(9, 7, CV_8UC1, cv::Scalar(255))), 0.0F);
}

TEST(GrayDeviation, OfHalfBlackHalfWhiteIsHalfTheRange) {
  cv::Mat gray(6, 10, CV_8UC1, cv::Scalar(0));
  gray.colRange(0, 5).setTo(255);
  EXPECT_EQ(grayDeviation(gray), 127.5F);
}

}  // namespace
}  // namespace cbmv::test
