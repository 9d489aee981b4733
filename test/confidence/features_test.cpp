#include "cbmv_stereo/confidence/features.h"

#include <cmath>
#include <limits>
#include <random>

#include "support/random_images.h"

namespace cbmv::test {
namespace {

/// Costs as a matcher could give them: in [0, 120], or in [−1, 1] for NCC.
CostRow randomCosts(const Shape& shape, int matcher) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> cost(matcher == kNcc ? -1.0F : 0.0F,
                                             matcher == kNcc ? 1.0F : 120.0F);
  CostRow costs;
  costs.resize(shape.width, shape.range.count);
  for (int i = 0; i < shape.range.count; ++i) {
    for (int x = 0; x < shape.width; ++x) {
      costs.line(i)[x] = matcher == kNcc ? cost(random) : std::round(cost(random));
    }
  }
  return costs;
}

struct Confidences {
  double log_ratio;
  double log_likelihood;
};

/// Straight from the formulas, over the competitors at constant x_L (left) or x_R (right).
Confidences naiveConfidences(const CostRow& costs, const Shape& shape, int x, int i, View view,
                             const MatcherConstants& constants) {
  const int x_right = x - shape.range.min - i;
  std::vector<double> competitors;
  for (int k = 0; k < shape.range.count; ++k) {
    const int left_column = view == View::kLeft ? x : x_right + shape.range.min + k;
    const int right_column = left_column - shape.range.min - k;
    if (left_column >= 0 && left_column < shape.width && right_column >= 0 &&
        right_column < shape.width) {
      competitors.push_back(costs.line(k)[left_column]);
    }
  }
  const double lowest = *std::min_element(competitors.begin(), competitors.end());
  const auto likelihood = [&](double cost) {
    return std::exp(-(cost - lowest) * (cost - lowest) / constants.two_sigma_squared);
  };
  double sum = 0;
  for (const double cost : competitors) {
    sum += likelihood(cost);
  }
  const double cost = costs.line(i)[x];
  return {std::log((lowest + constants.epsilon) / (cost + constants.epsilon)),
          -(cost - lowest) * (cost - lowest) / constants.two_sigma_squared - std::log(sum)};
}

class FeaturesTest : public testing::TestWithParam<std::tuple<Shape, int>> {};

TEST_P(FeaturesTest, EqualDefinitions) {
  const auto [shape, matcher] = GetParam();
  const MatcherConstants constants = kMatcherConstants[matcher];
  const CostRow costs = randomCosts(shape, matcher);
  RowTerms terms;
  computeRowTerms(costs, shape.width, shape.range, constants, terms);
  std::vector<std::vector<float>> values(kFeaturesPerMatcher, std::vector<float>(shape.width));
  const FeatureLines lines = {values[0].data(), values[1].data(), values[2].data(),
                              values[3].data(), values[4].data()};
  // Single-precision logarithms of values up to 2⁷; squared differences up to 120² / 128.
  const double tolerance = 2e-4;
  for (int i = 0; i < shape.range.count; ++i) {
    computeFeatures(costs, terms, shape.width, shape.range, i, constants, lines);
    const ColumnSpan span = matchedColumns(shape.width, shape.range.min + i);
    for (int x = span.begin; x < span.end; ++x) {
      const double cost = costs.line(i)[x];
      const Confidences left = naiveConfidences(costs, shape, x, i, View::kLeft, constants);
      const Confidences right = naiveConfidences(costs, shape, x, i, View::kRight, constants);
      ASSERT_NEAR(values[kCost][x],
                  constants.logarithmic_cost ? std::log(cost + constants.epsilon) : cost,
                  tolerance);
      ASSERT_NEAR(values[kRatioLow][x], std::min(left.log_ratio, right.log_ratio), tolerance);
      ASSERT_NEAR(values[kRatioHigh][x], std::max(left.log_ratio, right.log_ratio), tolerance);
      ASSERT_NEAR(values[kLikelihoodLow][x], std::min(left.log_likelihood, right.log_likelihood),
                  tolerance);
      ASSERT_NEAR(values[kLikelihoodHigh][x], std::max(left.log_likelihood, right.log_likelihood),
                  tolerance);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Shapes, FeaturesTest,
                         testing::Combine(testing::ValuesIn(awkwardShapes()),
                                          testing::Values(kCensus, kNcc, kZeroMeanSad)));

TEST(Features, MatchedColumnsAreThoseInside) {
  for (const Shape& shape : awkwardShapes()) {
    for (int d = shape.range.min; d <= shape.range.max(); ++d) {
      const ColumnSpan span = matchedColumns(shape.width, d);
      for (int x = 0; x < shape.width; ++x) {
        EXPECT_EQ(x >= span.begin && x < span.end, x - d >= 0 && x - d < shape.width);
      }
    }
  }
}

TEST(Quantize, IsFloorOfLinearMapCutToBytes) {
  const std::vector<float> values = {-1e30F, -5.0F, 0.0F, 0.49F, 0.51F, 60.0F, 126.4F, 1e30F};
  const std::vector<int> expected = {0, 0, 3, 3, 4, 123, 255, 255};
  std::vector<std::uint8_t> codes(values.size());
  quantize({2.0F, 3.0F}, values.data(), static_cast<int>(values.size()), codes.data());
  for (std::size_t i = 0; i < values.size(); ++i) {
    EXPECT_EQ(codes[i], expected[i]) << values[i];
  }
}

}  // namespace
}  // namespace cbmv::test
