#include "cbmv_stereo/confidence/features.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <variant>
#include <vector>

#include "support/random_images.h"
#include "support/simd_targets.h"

namespace cbmv::test {
namespace {

template <typename Cost>
void fillRandomly(const Shape& shape, double lowest, double highest, CostRow<Cost>& costs) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> cost(lowest, highest);
  costs.resize(shape.width, shape.range.count);
  for (int i = 0; i < shape.range.count; ++i) {
    for (int x = 0; x < shape.width; ++x) {
      costs.line(i)[x] = static_cast<Cost>(cost(random));
    }
  }
}

/// Costs as the matchers could give them.
MatcherCosts randomCosts(const Shape& shape) {
  MatcherCosts costs;
  fillRandomly(shape, 0, 121, costs.census);
  fillRandomly(shape, -1, 1, costs.ncc);
  fillRandomly(shape, 0, 481, costs.zero_mean_sad);
  fillRandomly(shape, 0, 51001, costs.sobel_sad);
  return costs;
}

/// In the unit of the matcher's constants.
double costAt(const MatcherCosts& costs, int matcher, int i, int x) {
  return std::visit(
      [&](const auto* row) {
        return kMatcherConstants[matcher].cost_unit * static_cast<double>(row->line(i)[x]);
      },
      costs.rows()[matcher]);
}

struct Confidences {
  double log_ratio;
  double log_likelihood;
};

/// Straight from the formulas, over the competitors at constant x_L (left) or x_R (right).
Confidences naiveConfidences(const MatcherCosts& costs, int matcher, const Shape& shape, int x,
                             int i, View view) {
  const MatcherConstants constants = kMatcherConstants[matcher];
  const int x_right = x - shape.range.min - i;
  std::vector<double> competitors;
  for (int k = 0; k < shape.range.count; ++k) {
    const int left_column = view == View::kLeft ? x : x_right + shape.range.min + k;
    const int right_column = left_column - shape.range.min - k;
    if (left_column >= 0 && left_column < shape.width && right_column >= 0 &&
        right_column < shape.width) {
      competitors.push_back(costAt(costs, matcher, k, left_column));
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
  const double cost = costAt(costs, matcher, i, x);
  return {std::log((lowest + constants.epsilon) / (cost + constants.epsilon)),
          -(cost - lowest) * (cost - lowest) / constants.two_sigma_squared - std::log(sum)};
}

using Lines = std::vector<std::vector<float>>;

/// Feature values [i · 5 + feature][x]; 0 where the match lies outside.
Lines computeAllFeatures(const CostRowPointer& costs, const Shape& shape,
                         const MatcherConstants& constants) {
  RowTerms terms;
  computeRowTerms(costs, shape.width, shape.range, constants, terms);
  Lines values(shape.range.count * kFeaturesPerMatcher, std::vector<float>(shape.width));
  for (int i = 0; i < shape.range.count; ++i) {
    std::vector<float>* first = &values[i * kFeaturesPerMatcher];
    computeFeatures(
        costs, terms, shape.width, shape.range, i, constants,
        {first[0].data(), first[1].data(), first[2].data(), first[3].data(), first[4].data()});
  }
  return values;
}

class FeaturesTest : public testing::TestWithParam<std::tuple<Shape, int>> {};

TEST_P(FeaturesTest, EqualDefinitions) {
  const auto [shape, matcher] = GetParam();
  const MatcherConstants constants = kMatcherConstants[matcher];
  const MatcherCosts costs = randomCosts(shape);
  const Lines values = computeAllFeatures(costs.rows()[matcher], shape, constants);
  for (int i = 0; i < shape.range.count; ++i) {
    const std::vector<float>* lines = &values[i * kFeaturesPerMatcher];
    const ColumnSpan span = matchedColumns(shape.width, shape.range.min + i);
    for (int x = span.begin; x < span.end; ++x) {
      const double cost = costAt(costs, matcher, i, x);
      const Confidences left = naiveConfidences(costs, matcher, shape, x, i, View::kLeft);
      const Confidences right = naiveConfidences(costs, matcher, shape, x, i, View::kRight);
      const auto expect = [&, x = x](Feature feature, double expected) {
        // Single precision; the logarithms are of values up to 2¹⁶.
        EXPECT_NEAR(lines[feature][x], expected, 2e-4 + 1e-6 * std::abs(expected)) << feature;
      };
      expect(kCost, constants.logarithmic_cost ? std::log(cost + constants.epsilon) : cost);
      expect(kRatioLow, std::min(left.log_ratio, right.log_ratio));
      expect(kRatioHigh, std::max(left.log_ratio, right.log_ratio));
      expect(kLikelihoodLow, std::min(left.log_likelihood, right.log_likelihood));
      expect(kLikelihoodHigh, std::max(left.log_likelihood, right.log_likelihood));
    }
  }
}

TEST_P(FeaturesTest, AreTheSameOnEveryInstructionSet) {
  const auto [shape, matcher] = GetParam();
  const MatcherConstants constants = kMatcherConstants[matcher];
  const MatcherCosts all_costs = randomCosts(shape);
  const CostRowPointer costs = all_costs.rows()[matcher];
  const Lines expected = computeAllFeatures(costs, shape, constants);
  onEverySimdTarget(
      [&, shape = shape] { EXPECT_EQ(computeAllFeatures(costs, shape, constants), expected); });
}

TEST_P(FeaturesTest, CodesAreQuantizedFeatures) {
  const auto [shape, matcher] = GetParam();
  const MatcherConstants constants = kMatcherConstants[matcher];
  const MatcherCosts all_costs = randomCosts(shape);
  const CostRowPointer costs = all_costs.rows()[matcher];
  const Lines values = computeAllFeatures(costs, shape, constants);
  const MatcherCodeMaps maps = {{{2, 3}, {20, 150}, {30, 250}, {9, 170}, {11, 260}}};
  onEverySimdTarget([&, shape = shape] {
    RowTerms terms;
    computeRowTerms(costs, shape.width, shape.range, constants, terms);
    for (int i = 0; i < shape.range.count; ++i) {
      std::vector<std::vector<std::uint8_t>> codes(kFeaturesPerMatcher,
                                                   std::vector<std::uint8_t>(shape.width, 77));
      computeCodes(
          costs, terms, shape.width, shape.range, i, constants, maps,
          {codes[0].data(), codes[1].data(), codes[2].data(), codes[3].data(), codes[4].data()});
      const ColumnSpan span = matchedColumns(shape.width, shape.range.min + i);
      for (int f = 0; f < kFeaturesPerMatcher; ++f) {
        const std::vector<float>& line = values[i * kFeaturesPerMatcher + f];
        for (int x = 0; x < shape.width; ++x) {
          const float code = std::floor(maps[f].scale * line[x] + maps[f].offset);
          const bool inside = x >= span.begin && x < span.end;
          ASSERT_EQ(codes[f][x], inside ? std::clamp(code, 0.0F, 255.0F) : 77);
        }
      }
    }
  });
}

INSTANTIATE_TEST_SUITE_P(Shapes, FeaturesTest,
                         testing::Combine(testing::ValuesIn(awkwardShapes()),
                                          testing::Values(kCensus, kNcc, kZeroMeanSad, kSobelSad)));

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
  onEverySimdTarget([&] {
    for (const int count : {1, 3, 8, 16, 17, 100}) {
      std::vector<float> repeated(count);
      for (int i = 0; i < count; ++i) {
        repeated[i] = values[i % values.size()];
      }
      std::vector<std::uint8_t> codes(count + 1, 42);
      quantize({2.0F, 3.0F}, repeated.data(), count, codes.data());
      for (int i = 0; i < count; ++i) {
        EXPECT_EQ(codes[i], expected[i % values.size()]) << repeated[i];
      }
      EXPECT_EQ(codes[count], 42) << "wrote behind the end";
    }
  });
}

}  // namespace
}  // namespace cbmv::test
