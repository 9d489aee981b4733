#include "refinement/median_filter.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "support/random_images.h"
#include "support/simd_targets.h"

#include "cbmv_stereo/error.h"

namespace cbmv::test {
namespace {

float naiveMedian(const cv::Mat& disparity, float invalid, int size, int y, int x) {
  if (disparity.at<float>(y, x) == invalid) {
    return invalid;
  }
  std::vector<float> values;
  for (int row = y - size / 2; row <= y + size / 2; ++row) {
    for (int column = x - size / 2; column <= x + size / 2; ++column) {
      if (isInside(disparity, row, column) && disparity.at<float>(row, column) != invalid) {
        values.push_back(disparity.at<float>(row, column));
      }
    }
  }
  std::sort(values.begin(), values.end());
  return values[(values.size() - 1) / 2];
}

void expectNaiveMedians(const Shape& shape, const cv::Mat& disparity, int size) {
  const float invalid = shape.range.invalid();
  cv::Mat expected(shape.size(), CV_32FC1);
  for (int y = 0; y < shape.height; ++y) {
    for (int x = 0; x < shape.width; ++x) {
      expected.at<float>(y, x) = naiveMedian(disparity, invalid, size, y, x);
    }
  }
  cv::Mat padded;
  onEverySimdTarget([&] {
    cv::Mat filtered;
    medianFilter(disparity, shape.range, size, padded, filtered);
    expectMap<float>(filtered, shape.size(),
                     [&](int y, int x) { return expected.at<float>(y, x); });
  });
}

class MedianFilter : public testing::TestWithParam<Case> {};

TEST_P(MedianFilter, EqualsNaiveOne) {
  const auto [shape, view, content] = GetParam();
  const std::uint32_t seed = view == View::kLeft ? 18 : 19;
  for (const int invalid_every : {1, 3, 30, 1000000}) {
    const cv::Mat disparity = makeDisparity(shape, content, invalid_every, seed);
    for (const int size : {1, 3, 5, 9}) {
      expectNaiveMedians(shape, disparity, size);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Shapes, MedianFilter, allCases());

TEST(MedianFilter, EqualsNaiveOneInTheLargestWindow) {
  const Shape shape{18, 21, {0, 30}};
  expectNaiveMedians(shape, makeDisparity(shape, Content::kNoise, 30, 20), kMaxMedianSizePx);
}

TEST(MedianFilter, RejectsEvenAndHugeSizes) {
  const cv::Mat disparity = cv::Mat::zeros(3, 3, CV_32FC1);
  cv::Mat padded;
  cv::Mat filtered;
  for (const int size : {-3, 0, 2, 4, 17}) {
    EXPECT_THROW(medianFilter(disparity, {}, size, padded, filtered), Error) << size;
  }
}

}  // namespace
}  // namespace cbmv::test
