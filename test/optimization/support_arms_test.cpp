#include "optimization/support_arms.h"

#include <cmath>

#include <gtest/gtest.h>

#include "support/random_images.h"
#include "support/simd_targets.h"

#include "cbmv_stereo/error.h"

namespace cbmv::test {
namespace {

int naiveArm(const cv::Mat& gray, int y, int x, int dy, int dx, int max_length, double threshold) {
  int length = 0;
  for (int n = 1; n < max_length && isInside(gray, y + n * dy, x + n * dx); ++n) {
    const int difference =
        gray.at<std::uint8_t>(y, x) - gray.at<std::uint8_t>(y + n * dy, x + n * dx);
    if (!(std::abs(difference) < threshold)) {
      break;
    }
    length = n;
  }
  return length;
}

cv::Vec4b naiveArms(const cv::Mat& gray, int y, int x, int max_length, double threshold) {
  return {static_cast<std::uint8_t>(naiveArm(gray, y, x, 0, -1, max_length, threshold)),
          static_cast<std::uint8_t>(naiveArm(gray, y, x, 0, 1, max_length, threshold)),
          static_cast<std::uint8_t>(naiveArm(gray, y, x, -1, 0, max_length, threshold)),
          static_cast<std::uint8_t>(naiveArm(gray, y, x, 1, 0, max_length, threshold))};
}

void expectNaiveArms(const cv::Mat& gray, int max_length, float threshold) {
  cv::Mat expected(gray.size(), CV_8UC4);
  for (int y = 0; y < gray.rows; ++y) {
    for (int x = 0; x < gray.cols; ++x) {
      expected.at<cv::Vec4b>(y, x) = naiveArms(gray, y, x, max_length, threshold);
    }
  }
  onEverySimdTarget([&] {
    cv::Mat arms;
    computeSupportArms(gray, max_length, threshold, arms);
    ASSERT_EQ(arms.type(), CV_8UC4);
    ASSERT_EQ(arms.size(), gray.size());
    EXPECT_EQ(cv::norm(arms, expected, cv::NORM_INF), 0);
  });
}

class SupportArms : public testing::TestWithParam<Case> {};

TEST_P(SupportArms, EqualNaiveOnes) {
  const auto [shape, view, content] = GetParam();
  const cv::Mat gray = makeGray(shape.size(), content, view == View::kLeft ? 1 : 2);
  for (const int max_length : {1, 6, 255}) {
    for (const float threshold : {-1.0F, 0.0F, 4.0F, 70.3F, 1000.0F}) {
      expectNaiveArms(gray, max_length, threshold);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Shapes, SupportArms, allCases());

TEST(SupportArms, EqualNaiveOnesInWideImages) {
  expectNaiveArms(makeGray({1100, 3}, Content::kPatches, 4), 255, 150.0F);
  expectNaiveArms(cv::Mat(2, 1100, CV_8UC1, cv::Scalar(7)), 255, 1.0F);
}

TEST(SupportArms, ReadsPartsOfImages) {
  const cv::Mat whole = makeGray({50, 40}, Content::kPatches, 3);
  const cv::Mat part = whole(cv::Rect(7, 5, 30, 20));
  cv::Mat arms_of_part;
  cv::Mat arms_of_copy;
  computeSupportArms(part, 9, 20.0F, arms_of_part);
  computeSupportArms(part.clone(), 9, 20.0F, arms_of_copy);
  EXPECT_EQ(cv::norm(arms_of_part, arms_of_copy, cv::NORM_INF), 0);
}

TEST(SupportArms, RejectsArmLengthsBeyondAByte) {
  cv::Mat arms;
  const cv::Mat gray = cv::Mat::zeros(3, 3, CV_8UC1);
  EXPECT_THROW(computeSupportArms(gray, 0, 1.0F, arms), Error);
  EXPECT_THROW(computeSupportArms(gray, 256, 1.0F, arms), Error);
}

}  // namespace
}  // namespace cbmv::test
