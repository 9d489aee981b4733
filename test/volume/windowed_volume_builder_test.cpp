#include "cbmv_stereo/volume/windowed_volume_builder.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "support/forest_fixture.h"
#include "support/random_forest.h"
#include "support/random_search_space.h"
#include "support/simd_targets.h"

#include "cbmv_stereo/confidence/features.h"
#include "cbmv_stereo/evaluation/rendered_scene.h"
#include "cbmv_stereo/volume/volume_builder.h"

namespace cbmv {
namespace {

struct Case {
  cv::Size size;
  DisparityRange range;
};

const std::vector<Case> kCases = {
    {{70, 5}, {0, 20}}, {{33, 4}, {-9, 15}}, {{64, 3}, {7, 30}}, {{20, 3}, {-30, 60}}};

/// Whether (x, i) of row y belongs to the space and has its match inside.
bool isWanted(const SearchSpace& space, int y, int x, int i) {
  const SearchSpace::Tile tile = space.tile(y, x / kTileColumns);
  const int match = x - space.range().min - i;
  return match >= 0 && match < space.width() &&
         std::binary_search(tile.indices, tile.indices + tile.count, static_cast<std::int16_t>(i));
}

/// Plain loops over the hypotheses of a row: terms of both views, features, codes, trees.
class RowReference {
 public:
  RowReference(const MatcherSet& matchers, const SearchSpace& space, const Forest& forest, int y)
      : space_(space), forest_(forest), y_(y) {
    MatcherSet::Scratch scratch;
    scratch.resize(space.width());
    matchers.computeRow(y, space.range(), allMatchers(), scratch, costs_);
  }

  /// Features of a hypothesis, not quantized.
  std::array<double, kFeatureCount> features(int x, int i) const {
    std::array<double, kFeatureCount> all{};
    for (int m = 0; m < kMatcherCount; ++m) {
      const MatcherConstants& c = kMatcherConstants[m];
      const double cost = costOf(m, x, i);
      const Terms left = terms(m, [&](int other_x, int) { return other_x == x; });
      const int right_x = x - i;
      const Terms right = terms(m, [&](int other_x, int j) { return other_x - j == right_x; });
      const auto ratio = [&](const Terms& t) {
        return std::log(t.lowest + c.epsilon) - std::log(cost + c.epsilon);
      };
      const auto likelihood = [&](const Terms& t) {
        return -(cost - t.lowest) * (cost - t.lowest) / c.two_sigma_squared - std::log(t.sum);
      };
      all[featureIndex(m, kCost)] = c.logarithmic_cost ? std::log(cost + c.epsilon) : cost;
      all[featureIndex(m, kRatioLow)] = std::min(ratio(left), ratio(right));
      all[featureIndex(m, kRatioHigh)] = std::max(ratio(left), ratio(right));
      all[featureIndex(m, kLikelihoodLow)] = std::min(likelihood(left), likelihood(right));
      all[featureIndex(m, kLikelihoodHigh)] = std::max(likelihood(left), likelihood(right));
    }
    return all;
  }

 private:
  struct Terms {
    double lowest = std::numeric_limits<double>::infinity();
    double sum = 0;
  };

  double costOf(int m, int x, int i) const {
    return std::visit([&](const auto* row) { return static_cast<double>(row->line(i)[x]); },
                      costs_.rows()[m]) *
           kMatcherConstants[m].cost_unit;
  }

  template <typename IsCompetitor>
  Terms terms(int m, const IsCompetitor& is_competitor) const {
    Terms found;
    std::vector<double> costs;
    for (int x = 0; x < space_.width(); ++x) {
      for (int i = 0; i < space_.range().count; ++i) {
        if (isWanted(space_, y_, x, i) && is_competitor(x, i)) {
          costs.push_back(costOf(m, x, i));
          found.lowest = std::min(found.lowest, costs.back());
        }
      }
    }
    for (const double cost : costs) {
      const double excess = cost - found.lowest;
      found.sum += std::exp(-excess * excess / kMatcherConstants[m].two_sigma_squared);
    }
    return found;
  }

  const SearchSpace& space_;
  const Forest& forest_;
  const int y_;
  MatcherCosts costs_;
};

/// Costs of a forest on features whose codes may be off by one, as sums of floats are.
std::pair<int, int> costRange(const Forest& forest, const std::array<double, kFeatureCount>& features) {
  std::array<std::vector<std::uint8_t>, kFeatureCount> codes;
  std::array<const std::uint8_t*, kFeatureCount> lines{};
  int lowest = 255;
  int highest = 0;
  const ForestEvaluator evaluator(forest);
  for (const double shift : {-1e-3, 0.0, 1e-3}) {
    for (int f = 0; f < kFeatureCount; ++f) {
      const CodeMap& map = forest.quantizer.maps[f];
      const double code = std::floor(map.scale * features[f] + map.offset + shift);
      codes[f] = {static_cast<std::uint8_t>(std::clamp(code, 0.0, 255.0))};
      lines[f] = codes[f].data();
    }
    std::uint8_t cost = 0;
    evaluator.evaluate(lines, 1, &cost);
    lowest = std::min<int>(lowest, cost);
    highest = std::max<int>(highest, cost);
  }
  return {lowest, highest};
}

void expectReference(const Case& c, const Forest& forest, std::uint32_t seed) {
  const RenderedScene scene = renderScene(c.size.width, c.size.height, static_cast<int>(seed));
  const SearchSpace space = test::makeSearchSpace(c.size.height, c.size.width, c.range, seed);
  WindowedMatchingVolume volume;
  WindowedVolumeBuilder().build(scene.left, scene.right, space, forest, ForestEvaluator(forest),
                                volume);
  MatcherSet matchers;
  matchers.prepare(scene.left, scene.right);
  int hypotheses = 0;
  int different = 0;
  for (int y = 0; y < c.size.height; ++y) {
    const RowReference reference(matchers, space, forest, y);
    for (int t = 0; t < space.tiles(); ++t) {
      const SearchSpace::Tile tile = space.tile(y, t);
      for (int k = 0; k < tile.count; ++k) {
        for (int x = t * kTileColumns; x < (t + 1) * kTileColumns; ++x) {
          const int cost = volume.entry(tile.first_entry + k)[x - t * kTileColumns];
          if (x >= c.size.width || !isWanted(space, y, x, tile.indices[k])) {
            ASSERT_EQ(cost, kOutsideCost);
            continue;
          }
          const auto [lowest, highest] =
              costRange(forest, reference.features(x, tile.indices[k]));
          ++hypotheses;
          different += cost < lowest || cost > highest;
        }
      }
    }
  }
  ASSERT_GT(hypotheses, 20);
  EXPECT_LE(different, hypotheses / 200) << "of " << hypotheses;  // codes at a border, several at once
}

TEST(WindowedVolumeBuilder, EqualsPlainLoopsOnEveryInstructionSet) {
  const Forest forest = test::makeForest(8, 6, 3);
  test::onEverySimdTarget([&] {
    for (const Case& c : kCases) {
      SCOPED_TRACE(c.size.width);
      expectReference(c, forest, 5);
    }
  });
}

void expectDense(const Case& c, const Forest& forest, WindowedVolumeBuilder& builder) {
  const RenderedScene scene = renderScene(c.size.width, c.size.height, 2);
  const ForestEvaluator evaluator(forest);
  SearchSpace space;
  space.buildExhaustive(c.size.height, c.size.width, c.range);
  WindowedMatchingVolume volume;
  builder.build(scene.left, scene.right, space, forest, evaluator, volume);
  MatchingVolume dense;
  VolumeBuilder().build(scene.left, scene.right, c.range, forest, evaluator, dense);
  for (int y = 0; y < c.size.height; ++y) {
    for (int x = 0; x < c.size.width; ++x) {
      const SearchSpace::Tile tile = space.tile(y, x / kTileColumns);
      for (int i = 0; i < c.range.count; ++i) {
        ASSERT_EQ(volume.entry(tile.first_entry + i)[x % kTileColumns], dense.pixel(y, x)[i])
            << y << " " << x << " " << i;
      }
    }
  }
}

TEST(WindowedVolumeBuilder, ExhaustiveSpacesGiveTheDenseVolume) {
  test::onEverySimdTarget([&] {
    WindowedVolumeBuilder builder;  // keeps its memory
    for (const Case& c : kCases) {
      expectDense(c, test::makeForest(8, 6, 3), builder);
      expectDense(c, makeForestFixture(), builder);
    }
  });
}

}  // namespace
}  // namespace cbmv
