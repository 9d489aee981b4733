#include "refinement/bilateral_filter.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "support/random_images.h"
#include "support/simd_targets.h"

#include "cbmv_stereo/error.h"

namespace cbmv::test {
namespace {

/// Along columns with (1, 0), along rows with (0, 1). Uses float and the order of the filter,
/// because a rounded mean of the first step may be on the other side of the threshold in the second
/// step.
float naiveMean(const cv::Mat& disparity, float invalid, float sigma, float threshold, int y, int x,
                const cv::Vec2i& axis) {
  const float center = disparity.at<float>(y, x);
  const int radius = static_cast<int>(std::ceil(3 * sigma));
  float differences = 0;
  float weights = 0;
  for (int offset = -radius; offset <= radius; ++offset) {
    const int row = y + offset * axis[0];
    const int column = x + offset * axis[1];
    if (!isInside(disparity, row, column) || disparity.at<float>(row, column) == invalid) {
      continue;
    }
    const float difference = disparity.at<float>(row, column) - center;
    if (std::abs(difference) < threshold) {
      const float weight = std::exp(-static_cast<float>(offset * offset) / (2 * sigma * sigma));
      differences += weight * difference;
      weights += weight;
    }
  }
  return center == invalid ? invalid : center + differences / weights;
}

cv::Mat naiveMeans(const cv::Mat& disparity, float invalid, float sigma, float threshold,
                   const cv::Vec2i& axis) {
  cv::Mat means(disparity.size(), CV_32FC1);
  for (int y = 0; y < means.rows; ++y) {
    for (int x = 0; x < means.cols; ++x) {
      means.at<float>(y, x) = naiveMean(disparity, invalid, sigma, threshold, y, x, axis);
    }
  }
  return means;
}

cv::Mat withFractions(cv::Mat disparity, float invalid) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> fraction(0, 1);
  for (float& d : cv::Mat_<float>(disparity)) {
    d += d == invalid ? 0.0F : fraction(random);
  }
  return disparity;
}

class BilateralFilter : public testing::TestWithParam<Case> {};

TEST_P(BilateralFilter, EqualsNaiveOne) {
  const auto [shape, view, content] = GetParam();
  const float invalid = shape.range.invalid();
  const std::uint32_t seed = view == View::kLeft ? 20 : 21;
  for (const int invalid_every : {1, 4, 1000000}) {
    const cv::Mat disparity =
        withFractions(makeDisparity(shape, content, invalid_every, seed), invalid);
    for (const auto& [sigma, threshold] : {std::pair(2.2F, 1.3F), {0.4F, 3.0F}, {1.0F, 9.5F}}) {
      const cv::Mat columns = naiveMeans(disparity, invalid, sigma, threshold, {1, 0});
      const cv::Mat expected = naiveMeans(columns, invalid, sigma, threshold, {0, 1});
      onEverySimdTarget([&, all = shape, s = sigma, t = threshold] {
        cv::Mat padded;
        cv::Mat filtered;
        bilateralFilter(disparity, all.range, s, t, padded, filtered);
        expectMap<float>(filtered, all.size(),
                         [&](int y, int x) { return expected.at<float>(y, x); });
      });
    }
  }
}

TEST_P(BilateralFilter, CopiesWithoutSigma) {
  const auto [shape, view, content] = GetParam();
  const cv::Mat disparity = makeDisparity(shape, content, view == View::kLeft ? 3 : 1000, 22);
  cv::Mat padded;
  cv::Mat filtered;
  bilateralFilter(disparity, shape.range, 0.0F, 1.0F, padded, filtered);
  EXPECT_NE(filtered.data, disparity.data);
  expectMap<float>(filtered, shape.size(), [&](int y, int x) { return disparity.at<float>(y, x); });
}

INSTANTIATE_TEST_SUITE_P(Shapes, BilateralFilter, allCases());

TEST(BilateralFilter, RejectsImpossibleOptions) {
  const cv::Mat disparity = cv::Mat::zeros(3, 3, CV_32FC1);
  cv::Mat padded;
  cv::Mat filtered;
  EXPECT_THROW(bilateralFilter(disparity, {}, -1.0F, 1.0F, padded, filtered), Error);
  EXPECT_THROW(bilateralFilter(disparity, {}, 1.0F, 0.0F, padded, filtered), Error);
}

}  // namespace
}  // namespace cbmv::test
