#include "confidence/features.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <variant>
#include <vector>

#include "support/random_images.h"
#include "support/random_search_space.h"
#include "support/simd_targets.h"

namespace cbmv::test {
namespace {

template <typename Cost>
void fillRandomly(int places, double lowest, double highest, CostRow<Cost>& costs) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> cost(lowest, highest);
  costs.resize(places);
  for (int h = 0; h < places * kTileColumns; ++h) {
    costs.entry(0)[h] = static_cast<Cost>(cost(random));
  }
}

/// Random costs in the range of the matchers.
MatcherCosts randomCosts(int places) {
  MatcherCosts costs;
  fillRandomly(places, 0, 121, costs.census);
  fillRandomly(places, -1, 1, costs.ncc);
  fillRandomly(places, 0, 481, costs.zero_mean_sad);
  fillRandomly(places, 0, 51001, costs.sobel_sad);
  return costs;
}

/// A hypothesis whose match is inside; number h of the row, place by place.
struct Hypothesis {
  int x, x_right, h;
};

std::vector<Hypothesis> hypothesesOf(const RowEntries& entries) {
  std::vector<Hypothesis> hypotheses;
  for (int place = 0; place < entries.count(); ++place) {
    const RowEntries::Entry& entry = entries.entries()[place];
    for (int k = entry.begin; k < entry.end; ++k) {
      hypotheses.push_back({entry.column + k, entry.right_column + k, place * kTileColumns + k});
    }
  }
  return hypotheses;
}

/// Cost in the unit of the matcher's constants.
double costAt(const MatcherCosts& costs, int matcher, int h) {
  return std::visit(
      [&](const auto* row) {
        return kMatcherConstants[matcher].cost_unit * static_cast<double>(row->entry(0)[h]);
      },
      costs.rows()[matcher]);
}

struct Confidences {
  double log_ratio;
  double log_likelihood;
};

/// Direct implementation of the formulas, over the competitors at constant x_L (left) or x_R
/// (right).
Confidences naiveConfidences(const MatcherCosts& costs, int matcher,
                             const std::vector<Hypothesis>& hypotheses,
                             const Hypothesis& hypothesis, View view) {
  const MatcherConstants constants = kMatcherConstants[matcher];
  std::vector<double> competitors;
  for (const Hypothesis& other : hypotheses) {
    if (view == View::kLeft ? other.x == hypothesis.x : other.x_right == hypothesis.x_right) {
      competitors.push_back(costAt(costs, matcher, other.h));
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
  const double cost = costAt(costs, matcher, hypothesis.h);
  return {std::log((lowest + constants.epsilon) / (cost + constants.epsilon)),
          -(cost - lowest) * (cost - lowest) / constants.two_sigma_squared - std::log(sum)};
}

/// The entries of one row, with costs.
struct Row {
  int width;
  RowEntries entries;
  MatcherCosts costs;
};

/// A row with the whole range in all tiles, or with windows.
Row makeRow(const Shape& shape, bool windows) {
  SearchSpace space;
  if (windows) {
    space = makeSearchSpace(1, shape.width, shape.range, 3);
  } else {
    space.buildExhaustive(1, shape.width, shape.range);
  }
  Row row{shape.width, {}, {}};
  row.entries.build(space, 0);
  row.costs = randomCosts(row.entries.count());
  return row;
}

RowTerms computeTerms(const Row& row, int matcher) {
  RowTerms terms;
  computeRowTerms(row.costs.rows()[matcher], row.entries, row.width, kMatcherConstants[matcher],
                  terms);
  return terms;
}

using Lines = std::array<std::vector<float>, kFeaturesPerMatcher>;

/// Feature values [feature][hypothesis]; 0 if the match is outside.
Lines computeAllFeatures(const Row& row, int matcher) {
  const RowTerms terms = computeTerms(row, matcher);
  const int count = row.entries.count();
  Lines values;
  FeatureLines lines{};
  for (int f = 0; f < kFeaturesPerMatcher; ++f) {
    values[f].resize(static_cast<std::size_t>(count) * kTileColumns);
    lines[f] = values[f].data();
  }
  computeFeatures(row.costs.rows()[matcher], terms, row.entries, {0, count},
                  kMatcherConstants[matcher], lines);
  Lines inside;
  for (int f = 0; f < kFeaturesPerMatcher; ++f) {
    inside[f].resize(values[f].size());
    for (const Hypothesis& hypothesis : hypothesesOf(row.entries)) {
      inside[f][hypothesis.h] = values[f][hypothesis.h];
    }
  }
  return inside;
}

class FeaturesTest : public testing::TestWithParam<std::tuple<Shape, int, bool>> {
 protected:
  Row row() const { return makeRow(std::get<0>(GetParam()), std::get<2>(GetParam())); }
  int matcher() const { return std::get<1>(GetParam()); }
};

TEST_P(FeaturesTest, EqualDefinitions) {
  const MatcherConstants constants = kMatcherConstants[matcher()];
  const Row row = this->row();
  const Lines values = computeAllFeatures(row, matcher());
  const std::vector<Hypothesis> hypotheses = hypothesesOf(row.entries);
  for (const Hypothesis& hypothesis : hypotheses) {
    const double cost = costAt(row.costs, matcher(), hypothesis.h);
    const Confidences left =
        naiveConfidences(row.costs, matcher(), hypotheses, hypothesis, View::kLeft);
    const Confidences right =
        naiveConfidences(row.costs, matcher(), hypotheses, hypothesis, View::kRight);
    const auto expect = [&](Feature feature, double expected) {
      // The tolerance is for single precision; the logarithms are of values up to 2¹⁶.
      EXPECT_NEAR(values[feature][hypothesis.h], expected, 2e-4 + 1e-6 * std::abs(expected))
          << feature;
    };
    expect(kCost, constants.logarithmic_cost ? std::log(cost + constants.epsilon) : cost);
    expect(kRatioLow, std::min(left.log_ratio, right.log_ratio));
    expect(kRatioHigh, std::max(left.log_ratio, right.log_ratio));
    expect(kLikelihoodLow, std::min(left.log_likelihood, right.log_likelihood));
    expect(kLikelihoodHigh, std::max(left.log_likelihood, right.log_likelihood));
  }
}

TEST_P(FeaturesTest, AreTheSameOnEveryInstructionSet) {
  const Row row = this->row();
  const Lines expected = computeAllFeatures(row, matcher());
  onEverySimdTarget([&] { EXPECT_EQ(computeAllFeatures(row, matcher()), expected); });
}

/// The code of a value, by the definition.
float codeOf(const CodeMap& map, float value) {
  return std::clamp(std::floor(map.scale * value + map.offset), 0.0F, 255.0F);
}

TEST_P(FeaturesTest, CodesAreQuantizedFeatures) {
  const Row row = this->row();
  const Lines values = computeAllFeatures(row, matcher());
  const std::array<CodeMap, kFeaturesPerMatcher> maps = {
      {{2, 3}, {20, 150}, {30, 250}, {9, 170}, {11, 260}}};
  const std::vector<Hypothesis> hypotheses = hypothesesOf(row.entries);
  onEverySimdTarget([&] {
    const RowTerms terms = computeTerms(row, matcher());
    for (int place = 0; place < row.entries.count(); place += CodeBlock::kPlaces) {
      const PlaceSpan places{place, std::min(place + CodeBlock::kPlaces, row.entries.count())};
      CodeBlock block{};
      computeCodes(row.costs.rows()[matcher()], terms, row.entries, places,
                   kMatcherConstants[matcher()], maps.data(), block.lines.data());
      for (const Hypothesis& hypothesis : hypotheses) {
        const int h = hypothesis.h - places.begin * kTileColumns;
        if (h >= 0 && h < places.count() * kTileColumns) {
          for (int f = 0; f < kFeaturesPerMatcher; ++f) {
            ASSERT_EQ(block.lines[f][h] + 128, codeOf(maps[f], values[f][hypothesis.h]));
          }
        }
      }
    }
  });
}

INSTANTIATE_TEST_SUITE_P(Shapes, FeaturesTest,
                         testing::Combine(testing::ValuesIn(awkwardShapes()),
                                          testing::Values(kCensus, kNcc, kZeroMeanSad, kSobelSad),
                                          testing::Bool()));

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
