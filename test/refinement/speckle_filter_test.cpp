#include "refinement/speckle_filter.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "support/random_images.h"

namespace cbmv::test {
namespace {

/// The pixels of the region of (x, y).
std::vector<cv::Point> naiveRegion(const cv::Mat& disparity, float invalid, double difference,
                                   const cv::Point& start) {
  cv::Mat seen(disparity.size(), CV_8UC1, cv::Scalar(0));
  std::vector<cv::Point> region = {start};
  seen.at<std::uint8_t>(start) = 1;
  for (std::size_t i = 0; i < region.size(); ++i) {
    const cv::Point at = region[i];
    for (const cv::Point& step : {cv::Point(1, 0), {-1, 0}, {0, 1}, {0, -1}}) {
      const cv::Point next = at + step;
      if (isInside(disparity, next.y, next.x) && seen.at<std::uint8_t>(next) == 0 &&
          disparity.at<float>(next) != invalid &&
          std::abs(disparity.at<float>(next) - disparity.at<float>(at)) <= difference) {
        seen.at<std::uint8_t>(next) = 1;
        region.push_back(next);
      }
    }
  }
  return region;
}

cv::Mat naiveFiltered(const cv::Mat& disparity, float invalid, int size, double difference) {
  cv::Mat filtered = disparity.clone();
  for (int y = 0; y < disparity.rows; ++y) {
    for (int x = 0; x < disparity.cols; ++x) {
      if (disparity.at<float>(y, x) != invalid &&
          static_cast<int>(naiveRegion(disparity, invalid, difference, {x, y}).size()) <= size) {
        filtered.at<float>(y, x) = invalid;
      }
    }
  }
  return filtered;
}

class SpeckleFilter : public testing::TestWithParam<Case> {};

/// Disparities in steps of 1/16 px, the unit of the filter.
TEST_P(SpeckleFilter, EqualsNaiveOne) {
  const auto [shape, view, content] = GetParam();
  const float invalid = shape.range.invalid();
  cv::Mat disparity = makeDisparity(shape, content, 9, 3);
  if (view == View::kRight) {
    std::mt19937 random(2);
    for (float& d : cv::Mat_<float>(disparity)) {
      d += d == invalid ? 0 : static_cast<float>(static_cast<int>(random() % 17) - 8) / 16;
    }
  }
  SpeckleBuffers buffers;
  for (const int size : {0, 1, 4, 30}) {
    for (const int difference : {0, 1, 4}) {
      const cv::Mat expected = naiveFiltered(disparity, invalid, size, difference);
      cv::Mat filtered = disparity.clone();
      removeSpeckles(shape.range, size, difference, buffers, filtered);
      expectMap<float>(filtered, shape.size(),
                       [&](int y, int x) { return expected.at<float>(y, x); });
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Shapes, SpeckleFilter, allCases());

/// In steps of 1/16 px they do not fit into 16 bits.
TEST(SpeckleFilter, TakesTheWidestRange) {
  const DisparityRange range{-2048, 4096};
  cv::Mat disparity(20, 30, CV_32FC1, cv::Scalar(range.max()));
  disparity.colRange(0, 15) = range.min;
  disparity.at<float>(10, 5) = range.min + 5;
  disparity.at<float>(10, 8) = range.min + 4;
  disparity.at<float>(10, 25) = range.max() - 5;
  SpeckleBuffers buffers;
  removeSpeckles(range, 100, 4, buffers, disparity);
  EXPECT_EQ(cv::countNonZero(disparity == range.invalid()), 2);
  EXPECT_EQ(disparity.at<float>(10, 5), range.invalid());
  EXPECT_EQ(disparity.at<float>(10, 25), range.invalid());
}

}  // namespace
}  // namespace cbmv::test
