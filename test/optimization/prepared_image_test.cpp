#include "optimization/prepared_image.h"

#include <cmath>

#include <gtest/gtest.h>

#include "support/random_images.h"

namespace cbmv::test {
namespace {

/// Standard deviation: root of the mean squared distance to the mean.
double naiveDeviation(const cv::Mat& grey) {
  double mean = 0;
  for (const auto value : cv::Mat_<std::uint8_t>(grey)) {
    mean += value / static_cast<double>(grey.total());
  }
  double variance = 0;
  for (const auto value : cv::Mat_<std::uint8_t>(grey)) {
    variance += (value - mean) * (value - mean) / static_cast<double>(grey.total());
  }
  return std::sqrt(variance);
}

TEST(GreyDeviation, EqualsTheFormula) {
  for (const Shape& shape : awkwardShapes()) {
    for (const Content content : {Content::kNoise, Content::kPatches}) {
      const cv::Mat grey = makeGrey(shape.size(), content, 1);
      const double expected = naiveDeviation(grey);
      EXPECT_NEAR(greyDeviation(grey), expected, 1e-6 * expected) << shape << ", " << content;
    }
  }
}

TEST(GreyDeviation, OfOneGreyIsZero) {
  EXPECT_EQ(greyDeviation(cv::Mat(1, 1, CV_8UC1, cv::Scalar(200))), 0.0F);
  EXPECT_EQ(greyDeviation(cv::Mat(9, 7, CV_8UC1, cv::Scalar(255))), 0.0F);
}

TEST(GreyDeviation, OfHalfBlackHalfWhiteIsHalfTheRange) {
  cv::Mat grey(6, 10, CV_8UC1, cv::Scalar(0));
  grey.colRange(0, 5).setTo(255);
  EXPECT_EQ(greyDeviation(grey), 127.5F);
}

}  // namespace
}  // namespace cbmv::test
