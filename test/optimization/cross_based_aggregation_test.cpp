#include "optimization/cross_based_aggregation.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "optimization/support_arms.h"
#include "support/random_images.h"
#include "support/simd_targets.h"

namespace cbmv::test {
namespace {

enum Channel { kLeft = 0, kRight = 1, kUp = 2, kDown = 3 };

struct Naive {
  const AggregatedVolume& costs;
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

SupportArms makeArms(const cv::Size& size, Content content, int max_length, float threshold) {
  SupportArms arms;
  computeSupportArms(makeGray(size, content, 5), max_length, threshold, arms.reference);
  computeSupportArms(makeGray(size, content, 6), max_length, threshold, arms.other);
  arms.longest_px = max_length - 1;
  return arms;
}

void expectNaiveMeans(const Shape& shape, View view, Content content, int max_length,
                      float threshold, int max_cost) {
  const SupportArms arms = makeArms(shape.size(), content, max_length, threshold);
  const AggregatedVolume costs = makeCosts(shape, content, max_cost, 7);
  const Naive naive{costs, arms.reference, arms.other, view, shape.range};
  AggregatedVolume expected(shape.height, shape.width, shape.range.count);
  for (int y = 0; y < shape.height; ++y) {
    for (int x = 0; x < shape.width; ++x) {
      for (int i = 0; i < shape.range.count; ++i) {
        expected.pixel(y, x)[i] = static_cast<std::uint16_t>(naive.mean(y, x, i));
      }
    }
  }
  const auto expect_means = [&](const AggregatedVolume& aggregated) {
    expectVolume(aggregated, shape, [&](int y, int x, int i) { return expected.pixel(y, x)[i]; });
  };
  CostAggregator aggregator;
  onEverySimdTarget([&] {
    AggregatedVolume aggregated;
    aggregator.aggregate(costs, max_cost, arms, view, shape.range, aggregated);
    expect_means(aggregated);
    if (max_cost <= 255) {
      MatchingVolume bytes(shape.height, shape.width, shape.range.count);
      std::copy_n(costs.row(0), costs.size(), bytes.row(0));
      aggregator.aggregate(bytes, max_cost, arms, view, shape.range, aggregated);
      expect_means(aggregated);
    }
  });
}

class CostAggregation : public testing::TestWithParam<Case> {};

TEST_P(CostAggregation, EqualsNaiveMeans) {
  const auto [shape, view, content] = GetParam();
  expectNaiveMeans(shape, view, content, 6, 40.0F, 5355);
  expectNaiveMeans(shape, view, content, 1, 40.0F, 255);
  expectNaiveMeans(shape, view, content, 6, 300.0F, 255);
}

TEST_P(CostAggregation, EqualsNaiveMeansOverLongArms) {
  const auto [shape, view, content] = GetParam();
  expectNaiveMeans(shape, view, content, 12, 300.0F, 16383);
  expectNaiveMeans(shape, view, content, 12, 300.0F, 255);
}

INSTANTIATE_TEST_SUITE_P(Shapes, CostAggregation, allCases());

// The largest costs whose sums fit into 16 bits, and the smallest that do not; arms of one pixel,
// of default length, and of maximum length.
TEST(CostAggregation, IsExactWhereSumsNeed16Bits) {
  for (const auto& [arm, max_cost] :
       {std::pair(1, 16383), {5, 8665}, {5, 8666}, {7, 4660}, {7, 4661}}) {
    expectNaiveMeans({41, 80, {-2, 3}}, View::kLeft, Content::kNoise, arm + 1, 300.0F, max_cost);
    expectNaiveMeans({23, 40, {-2, 3}}, View::kRight, Content::kPatches, arm + 1, 300.0F, max_cost);
  }
}

// Means close to halves, for large costs and large regions, where rounding is most difficult.
TEST(CostAggregation, RoundsHalvesUp) {
  for (const int max_cost : {4660, 4659, 9, 1}) {
    const Shape shape{15, 400, {0, 1}};
    const SupportArms arms = makeArms(shape.size(), Content::kNoise, 8, 300.0F);
    AggregatedVolume costs(shape.height, shape.width, 1);
    for (int i = 0; i < shape.height * shape.width; ++i) {
      costs.row(0)[i] = static_cast<std::uint16_t>(max_cost - i % 2);
    }
    const Naive naive{costs, arms.reference, arms.other, View::kLeft, shape.range};
    onEverySimdTarget([&] {
      AggregatedVolume aggregated;
      CostAggregator().aggregate(costs, max_cost, arms, View::kLeft, shape.range, aggregated);
      expectVolume(aggregated, shape, [&](int y, int x, int i) { return naive.mean(y, x, i); });
    });
  }
}

// Up to 509² pixels, whose sum just fits into 32 bits.
TEST(CostAggregation, IsExactForTheLargestRegions) {
  const Shape shape{509, 509, {0, 1}};
  cv::Mat flat_arms;
  computeSupportArms(cv::Mat::zeros(shape.size(), CV_8UC1), 255, 1.0F, flat_arms);
  AggregatedVolume costs(509, 509, 1);
  std::fill(costs.row(0), costs.row(0) + costs.size(), 16383);
  AggregatedVolume aggregated;
  CostAggregator().aggregate(costs, 16383, {flat_arms, flat_arms, 254}, View::kLeft, shape.range,
                             aggregated);
  expectVolume(aggregated, shape, [](int, int, int) { return 16383; });
}

TEST(CostAggregation, DoesNotDependOnThreads) {
  const Shape shape{33, 150, {0, 70}};
  const SupportArms arms = makeArms(shape.size(), Content::kPatches, 6, 40.0F);
  const AggregatedVolume costs = makeCosts(shape, Content::kNoise, 5355, 8);
  AggregatedVolume parallel;
  CostAggregator().aggregate(costs, 5355, arms, View::kLeft, shape.range, parallel);
  const tbb::global_control single(tbb::global_control::max_allowed_parallelism, 1);
  AggregatedVolume serial;
  CostAggregator().aggregate(costs, 5355, arms, View::kLeft, shape.range, serial);
  expectVolume(parallel, shape, [&](int y, int x, int i) { return serial.pixel(y, x)[i]; });
}

}  // namespace
}  // namespace cbmv::test
