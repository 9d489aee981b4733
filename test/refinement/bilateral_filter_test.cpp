#include "cbmv_stereo/refinement/bilateral_filter.h"

#include <cmath>

#include <gtest/gtest.h>

#include "support/random_images.h"
#include "support/simd_targets.h"

#include "cbmv_stereo/error.h"

namespace cbmv::test {
namespace {

double naiveMean(const cv::Mat& disparity, float invalid, double sigma, double threshold, int y,
                 int x) {
  const double centre = disparity.at<float>(y, x);
  if (centre == invalid) {
    return invalid;
  }
  const int radius = static_cast<int>(std::ceil(3 * sigma));
  double sum = 0;
  double weights = 0;
  for (int dy = -radius; dy <= radius; ++dy) {
    for (int dx = -radius; dx <= radius; ++dx) {
      if (!isInside(disparity, y + dy, x + dx)) {
        continue;
      }
      const double value = disparity.at<float>(y + dy, x + dx);
      if (value != invalid && std::abs(value - centre) < threshold) {
        const double weight = std::exp(-(dx * dx + dy * dy) / (2 * sigma * sigma));
        sum += weight * value;
        weights += weight;
      }
    }
  }
  return sum / weights;
}

class BilateralFilter : public testing::TestWithParam<Case> {};

TEST_P(BilateralFilter, EqualsNaiveOne) {
  const auto [shape, view, content] = GetParam();
  const float invalid = shape.range.invalid();
  const std::uint32_t seed = view == View::kLeft ? 20 : 21;
  for (const int invalid_every : {1, 4, 1000000}) {
    const cv::Mat disparity = makeDisparity(shape, content, invalid_every, seed);
    for (const auto& [sigma, threshold] : {std::pair(2.2F, 1.3F), {0.4F, 3.0F}, {1.0F, 9.5F}}) {
      cv::Mat expected(shape.size(), CV_64FC1);
      for (int y = 0; y < shape.height; ++y) {
        for (int x = 0; x < shape.width; ++x) {
          expected.at<double>(y, x) = naiveMean(disparity, invalid, sigma, threshold, y, x);
        }
      }
      onEverySimdTarget([&, all = shape, s = sigma, t = threshold] {
        cv::Mat padded;
        cv::Mat filtered;
        bilateralFilter(disparity, all.range, s, t, padded, filtered);
        expectMap<float>(
            filtered, all.size(), [&](int y, int x) { return expected.at<double>(y, x); }, 1e-5);
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
