#include "volume/windowed_volume_builder.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <variant>
#include <vector>

#include <tbb/global_control.h>

#include "confidence/features.h"
#include "matching/matcher_set.h"
#include "support/matching_reference.h"
#include "support/random_forest.h"
#include "support/random_search_space.h"
#include "volume/volume_builder.h"

namespace cbmv::test {
namespace {

struct Scene {
  explicit Scene(const Shape& shape)
      : left(makeGray(shape.size(), Content::kPatches, 1)),
        right(makeGray(shape.size(), Content::kPatches, 2)) {}
  cv::Mat left, right;
};

WindowedMatchingVolume build(WindowedVolumeBuilder& builder, const Scene& scene,
                             const SearchSpace& space, const Forest& forest) {
  WindowedMatchingVolume volume;
  builder.build(scene.left, scene.right, space, forest, ForestEvaluator(forest), volume);
  return volume;
}

std::vector<std::uint8_t> costsOf(const WindowedMatchingVolume& volume) {
  return {volume.entry(0), volume.entry(volume.entries())};
}

/// Plain loops over the hypotheses of one row: costs of the whole range, terms of the space only.
class RowReference {
 public:
  RowReference(const MatcherSet& matchers, const SearchSpace& space, int y)
      : space_(space), y_(y), all_(allEntries({1, space.width(), space.range()})) {
    MatcherSet::Scratch scratch;
    scratch.resize(space.width());
    matchers.computeRow(y, all_, allMatchers(), scratch, costs_);
    for (int m = 0; m < kMatcherCount; ++m) {
      findTerms(m);
    }
  }

  /// Whether hypothesis (x, i) is in the space and has its match inside.
  bool isWanted(int x, int i) const {
    const SearchSpace::Tile tile = space_.tile(y_, x / kTileColumns);
    const int match = x - space_.range().min - i;
    return match >= 0 && match < space_.width() &&
           std::binary_search(tile.indices, tile.indices + tile.count,
                              static_cast<std::int16_t>(i));
  }

  std::array<double, kFeatureCount> features(int x, int i) const {
    std::array<double, kFeatureCount> all{};
    for (int m = 0; m < kMatcherCount; ++m) {
      const MatcherConstants& c = kMatcherConstants[m];
      const double cost = costOf(m, x, i);
      const Terms& left = left_[m][x];
      const Terms& right = right_[m][x - space_.range().min - i];
      const auto ratio = [&](const Terms& terms) {
        return std::log(terms.lowest + c.epsilon) - std::log(cost + c.epsilon);
      };
      const auto likelihood = [&](const Terms& terms) {
        return -std::pow(cost - terms.lowest, 2) / c.two_sigma_squared - std::log(terms.sum);
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
    const std::size_t h = hypothesisOf(all_, i, x);
    return std::visit([h](const auto* row) { return static_cast<double>(row->entry(0)[h]); },
                      costs_.rows()[m]) *
           kMatcherConstants[m].cost_unit;
  }

  /// Calls use(x, i, terms) for both pixels of each hypothesis of the space.
  template <typename Use>
  void forTerms(int m, const Use& use) {
    for (int x = 0; x < space_.width(); ++x) {
      for (int i = 0; i < space_.range().count; ++i) {
        if (isWanted(x, i)) {
          use(x, i, left_[m][x]);
          use(x, i, right_[m][x - space_.range().min - i]);
        }
      }
    }
  }

  void findTerms(int m) {
    left_[m].resize(space_.width());
    right_[m].resize(space_.width());
    forTerms(m, [&](int x, int i, Terms& terms) {
      terms.lowest = std::min(terms.lowest, costOf(m, x, i));
    });
    forTerms(m, [&](int x, int i, Terms& terms) {
      const double excess = costOf(m, x, i) - terms.lowest;
      terms.sum += std::exp(-excess * excess / kMatcherConstants[m].two_sigma_squared);
    });
  }

  const SearchSpace& space_;
  const int y_;
  const RowEntries all_;
  MatcherCosts costs_;
  std::array<std::vector<Terms>, kMatcherCount> left_, right_;
};

/// Whether the cost is possible for the forest if codes vary by the error of single precision: a
/// value at the limit of two codes may get either.
bool isPossible(const Forest& forest, const std::array<double, kFeatureCount>& features, int cost) {
  constexpr double kTolerance = 0.02;  // codes
  int lowest = 255;
  int highest = 0;
  for (const double shift : {-kTolerance, 0.0, kTolerance}) {
    const int possible = naiveForestCost(forest, [&](int f) {
      const CodeMap& map = forest.quantizer.maps[f];
      return std::clamp(std::floor(map.scale * features[f] + map.offset + shift), 0.0, 255.0);
    });
    lowest = std::min(lowest, possible);
    highest = std::max(highest, possible);
  }
  return cost >= lowest && cost <= highest;
}

class WindowedVolumeBuilderTest : public testing::TestWithParam<Shape> {
 protected:
  const Shape& shape() const { return GetParam(); }
  SearchSpace windows(std::uint32_t seed) const {
    return makeSearchSpace(shape().height, shape().width, shape().range, seed);
  }
  const Scene scene_{GetParam()};
  const Forest forest_ = makeForest(8, 6, 5);
};

TEST_P(WindowedVolumeBuilderTest, HoldsTheForestsAnswerWithCompetitorsOfTheSpace) {
  const SearchSpace space = windows(1);
  WindowedVolumeBuilder builder;
  const WindowedMatchingVolume volume = build(builder, scene_, space, forest_);
  MatcherSet matchers;
  matchers.prepare(scene_.left, scene_.right);
  int hypotheses = 0;
  int different = 0;
  for (int y = 0; y < shape().height; ++y) {
    const RowReference reference(matchers, space, y);
    for (int t = 0; t < space.tiles(); ++t) {
      const SearchSpace::Tile tile = space.tile(y, t);
      for (int k = 0; k < tile.count; ++k) {
        for (int column = 0; column < kTileColumns; ++column) {
          const int x = t * kTileColumns + column;
          const int cost = volume.entry(tile.first_entry + k)[column];
          if (x >= shape().width || !reference.isWanted(x, tile.indices[k])) {
            ASSERT_EQ(cost, kOutsideCost);
            continue;
          }
          ++hypotheses;
          different += isPossible(forest_, reference.features(x, tile.indices[k]), cost) ? 0 : 1;
        }
      }
    }
  }
  // If several codes are at a limit at once, other costs are possible, too.
  EXPECT_LE(different, hypotheses / 200) << "of " << hypotheses;
}

TEST_P(WindowedVolumeBuilderTest, IsTheSameOnEveryInstructionSet) {
  const SearchSpace space = windows(2);
  WindowedVolumeBuilder builder;
  const std::vector<std::uint8_t> expected = costsOf(build(builder, scene_, space, forest_));
  onEverySimdTarget([&] { EXPECT_EQ(costsOf(build(builder, scene_, space, forest_)), expected); });
}

TEST_P(WindowedVolumeBuilderTest, DoesNotDependOnThreadsAndEarlierFrames) {
  const SearchSpace space = windows(3);
  WindowedVolumeBuilder builder;
  const std::vector<std::uint8_t> expected = costsOf(build(builder, scene_, space, forest_));
  SearchSpace other;
  other.buildExhaustive(shape().height + 3, shape().width + 40, {-7, 30});
  build(builder, Scene({shape().height + 3, shape().width + 40, {}}), other, makeForest(9, 4, 7));
  const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(costsOf(build(builder, scene_, space, forest_)), expected);
}

void expectDense(const Shape& shape, const Scene& scene, const Forest& forest) {
  SearchSpace space;
  space.buildExhaustive(shape.height, shape.width, shape.range);
  WindowedVolumeBuilder builder;
  const WindowedMatchingVolume volume = build(builder, scene, space, forest);
  MatchingVolume dense;
  VolumeBuilder().build(scene.left, scene.right, shape.range, forest, ForestEvaluator(forest),
                        dense);
  for (int y = 0; y < shape.height; ++y) {
    for (int x = 0; x < shape.width; ++x) {
      const SearchSpace::Tile tile = space.tile(y, x / kTileColumns);
      for (int i = 0; i < shape.range.count; ++i) {
        ASSERT_EQ(volume.entry(tile.first_entry + i)[x % kTileColumns], dense.pixel(y, x)[i])
            << "y " << y << " x " << x << " i " << i;
      }
    }
  }
}

TEST_P(WindowedVolumeBuilderTest, ExhaustiveSpacesGiveTheDenseVolume) {
  expectDense(shape(), scene_, forest_);
}

TEST_P(WindowedVolumeBuilderTest, GeneralTreesGiveTheDenseVolume) {
  expectDense(shape(), scene_, makeGeneralForest(10, 20, 5));
}

INSTANTIATE_TEST_SUITE_P(Shapes, WindowedVolumeBuilderTest, testing::ValuesIn(awkwardShapes()));

TEST(WindowedVolumeBuilder, AcceptsAnEmptySpace) {
  const Shape shape{3, 40, {0, 5}};
  SearchSpace space;
  space.build(shape.height, shape.width, shape.range, [](int, SearchSpace::Row& row) {
    for (int t = 0; t < 3; ++t) {
      row.endTile();
    }
  });
  WindowedVolumeBuilder builder;
  EXPECT_EQ(build(builder, Scene(shape), space, makeForest(3, 4, 5)).entries(), 0U);
}

}  // namespace
}  // namespace cbmv::test
