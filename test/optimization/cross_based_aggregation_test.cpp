#include "cbmv_stereo/optimization/cross_based_aggregation.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "support/random_images.h"

#include "cbmv_stereo/optimization/support_arms.h"

namespace cbmv::test {
namespace {

enum Channel { kLeft = 0, kRight = 1, kUp = 2, kDown = 3 };

struct Naive {
  const OptimizedVolume& costs;
  const cv::Mat& reference_arms;
  const cv::Mat& other_arms;
  View view;
  DisparityRange range;

  int arm(int y, int x, int i, Channel channel) const {
    const int match = matchingColumn(view, x, range.min + i);
    return std::min(reference_arms.at<cv::Vec4b>(y, x)[channel],
                    other_arms.at<cv::Vec4b>(y, match)[channel]);
  }

  int mean(int y, int x, int i) const {
    if (!isInside(other_arms, y, matchingColumn(view, x, range.min + i))) {
      return costs.pixel(y, x)[i];
    }
    std::int64_t sum = 0;
    std::int64_t pixels = 0;
    for (int row = y - arm(y, x, i, kUp); row <= y + arm(y, x, i, kDown); ++row) {
      const int last = x + arm(row, x, i, kRight);
      for (int column = x - arm(row, x, i, kLeft); column <= last; ++column) {
        sum += costs.pixel(row, column)[i];
        ++pixels;
      }
    }
    return static_cast<int>((2 * sum + pixels) / (2 * pixels));
  }
};

struct ArmPair {
  ArmPair(const cv::Size& size, Content content, int max_length, float threshold) {
    computeSupportArms(makeGrey(size, content, 5), max_length, threshold, reference);
    computeSupportArms(makeGrey(size, content, 6), max_length, threshold, other);
  }
  cv::Mat reference;
  cv::Mat other;
};

void expectNaiveMeans(const Shape& shape, View view, Content content, int max_length,
                      float threshold, int max_cost) {
  const ArmPair arms(shape.size(), content, max_length, threshold);
  const OptimizedVolume costs = makeCosts(shape, content, max_cost, 7);
  OptimizedVolume aggregated;
  aggregateCosts(costs, arms.reference, arms.other, view, shape.range, aggregated);
  const Naive naive{costs, arms.reference, arms.other, view, shape.range};
  expectVolume(aggregated, shape, [&](int y, int x, int i) { return naive.mean(y, x, i); });
}

class AggregateCosts : public testing::TestWithParam<Case> {};

TEST_P(AggregateCosts, EqualsNaiveMeans) {
  const auto [shape, view, content] = GetParam();
  expectNaiveMeans(shape, view, content, 6, 40.0F, 5355);
  expectNaiveMeans(shape, view, content, 1, 40.0F, 255);
}

TEST_P(AggregateCosts, EqualsNaiveMeansOverLongArms) {
  const auto [shape, view, content] = GetParam();
  expectNaiveMeans(shape, view, content, 12, 300.0F, 16383);
}

INSTANTIATE_TEST_SUITE_P(Shapes, AggregateCosts, allCases());

// The longest arms whose sums are divided in float, and the shortest that are not.
TEST(AggregateCosts, IsExactWhereSumsNeed24Bits) {
  for (const int max_length : {16, 17}) {
    expectNaiveMeans({41, 80, {-2, 3}}, View::kLeft, Content::kNoise, max_length, 300.0F, 16383);
  }
}

// Up to 509² pixels, whose sum just fits 32 bits.
TEST(AggregateCosts, IsExactForTheLargestRegions) {
  const Shape shape{509, 509, {0, 1}};
  cv::Mat flat_arms;
  computeSupportArms(cv::Mat::zeros(shape.size(), CV_8UC1), 255, 1.0F, flat_arms);
  OptimizedVolume costs(509, 509, 1);
  std::fill(costs.row(0), costs.row(0) + costs.size(), 16383);
  OptimizedVolume aggregated;
  aggregateCosts(costs, flat_arms, flat_arms, View::kLeft, shape.range, aggregated);
  expectVolume(aggregated, shape, [](int, int, int) { return 16383; });
}

TEST(AggregateCosts, DoesNotDependOnThreads) {
  const Shape shape{33, 150, {0, 70}};
  const ArmPair arms(shape.size(), Content::kPatches, 6, 40.0F);
  const OptimizedVolume costs = makeCosts(shape, Content::kNoise, 5355, 8);
  OptimizedVolume parallel;
  aggregateCosts(costs, arms.reference, arms.other, View::kLeft, shape.range, parallel);
  const tbb::global_control single(tbb::global_control::max_allowed_parallelism, 1);
  OptimizedVolume serial;
  aggregateCosts(costs, arms.reference, arms.other, View::kLeft, shape.range, serial);
  expectVolume(parallel, shape, [&](int y, int x, int i) { return serial.pixel(y, x)[i]; });
}

}  // namespace
}  // namespace cbmv::test
