#include "volume/volume_builder.h"

#include <algorithm>
#include <cmath>

#include "confidence/row_features.h"
#include "support/matching_reference.h"
#include "support/random_forest.h"
#include "support/random_images.h"
#include "support/simd_targets.h"

namespace cbmv::test {
namespace {

MatchingVolume buildVolume(const Shape& shape, const Forest& forest) {
  MatchingVolume volume;
  VolumeBuilder().build(makeGray(shape.size(), Content::kPatches, 1),
                        makeGray(shape.size(), Content::kPatches, 2), shape.range, forest,
                        ForestEvaluator(forest), volume);
  return volume;
}

class VolumeBuilderTest : public testing::TestWithParam<Shape> {};

/// Expects `cost_of(features, h)` at each hypothesis inside; h is its index within its disparity.
template <typename CostOf>
void expectCosts(const Shape& shape, const MatchingVolume& volume, const CostOf& cost_of) {
  MatcherSet matchers;
  matchers.prepare(makeGray(shape.size(), Content::kPatches, 1),
                   makeGray(shape.size(), Content::kPatches, 2));
  const RowEntries entries = allEntries(shape);
  RowFeatures features;
  for (int y = 0; y < shape.height; ++y) {
    features.prepareRow(matchers, y, shape.width, entries);
    for (int i = 0; i < shape.range.count; ++i) {
      const PlaceSpan places = entries.places(i);
      features.compute(places);
      for (int x = 0; x < shape.width; ++x) {
        const int x_right = x - shape.range.min - i;
        const bool inside = x_right >= 0 && x_right < shape.width;
        ASSERT_EQ(
            volume.pixel(y, x)[i],
            inside ? cost_of(features, x - entries.entries()[places.begin].column) : kOutsideCost)
            << "y " << y << " x " << x << " i " << i;
      }
    }
  }
}

TEST_P(VolumeBuilderTest, HoldsTheForestsAnswerToEachHypothesis) {
  const Forest forest = makeForest(30, 6, 5);
  expectCosts(GetParam(), buildVolume(GetParam(), forest), [&](const RowFeatures& row, int h) {
    return naiveForestCost(forest, [&](int f) {
      const CodeMap& map = forest.quantizer.maps[f];
      return std::clamp(std::floor(map.scale * row.line(f)[h] + map.offset), 0.0F, 255.0F);
    });
  });
}

TEST_P(VolumeBuilderTest, HoldsTheAnswerOfGeneralTrees) {
  Forest forest = makeGeneralForest(30, 40, 5);
  forest.output = ForestOutput::kProbability;  // sums of leaves are exact, so costs are too
  expectCosts(GetParam(), buildVolume(GetParam(), forest), [&](const RowFeatures& row, int h) {
    const double probability = naiveProbability(forest, [&](int f) { return row.line(f)[h]; });
    return static_cast<std::uint8_t>(std::lround(255 * (1 - probability)));
  });
}

TEST_P(VolumeBuilderTest, MatchersThatNoTreeAsksForDoNotMatter) {
  const Shape shape = GetParam();
  Forest forest = makeForest(30, 6, 5);
  for (ObliviousTree& tree : forest.trees) {
    for (ObliviousTree::Level& level : tree.levels) {
      level.feature = static_cast<std::uint8_t>(level.feature % (2 * kFeaturesPerMatcher));
    }
  }
  Forest asks_for_all =
      forest;  // the result is the same, because all leaves of the new tree are zero
  for (const int matcher : {kCensus, kNcc, kZeroMeanSad, kSobelSad}) {
    const auto feature = static_cast<std::uint8_t>(featureIndex(matcher, kCost));
    asks_for_all.trees.push_back({{{feature, 9}}, {0, 0}});
  }
  const MatchingVolume volume = buildVolume(shape, forest);
  const MatchingVolume expected = buildVolume(shape, asks_for_all);
  EXPECT_TRUE(std::equal(volume.row(0), volume.row(0) + volume.size(), expected.row(0)));
}

TEST_P(VolumeBuilderTest, IsTheSameOnEveryInstructionSet) {
  const Shape shape = GetParam();
  const Forest forest = makeForest(30, 6, 5);
  const MatchingVolume expected = buildVolume(shape, forest);
  onEverySimdTarget([&] {
    const MatchingVolume volume = buildVolume(shape, forest);
    EXPECT_TRUE(std::equal(volume.row(0), volume.row(0) + volume.size(), expected.row(0)));
  });
}

TEST_P(VolumeBuilderTest, RightViewIsShiftedLeftView) {
  const Shape shape = GetParam();
  const MatchingVolume left = buildVolume(shape, makeForest(30, 6, 5));
  MatchingVolume right = left;
  PerThread<std::vector<std::uint8_t>> rows;
  shiftToRightView(shape.range, right, rows);
  for (int y = 0; y < shape.height; ++y) {
    for (int x = 0; x < shape.width; ++x) {
      for (int i = 0; i < shape.range.count; ++i) {
        const int left_x = x + shape.range.min + i;
        const bool inside = left_x >= 0 && left_x < shape.width;
        ASSERT_EQ(right.pixel(y, x)[i], inside ? left.pixel(y, left_x)[i] : kOutsideCost);
      }
    }
  }
}

/// Mirrored images with left and right exchanged yield the mirrored volume of the right view: the
/// forest does not depend on which image is left.
TEST_P(VolumeBuilderTest, SwappingTheImagesGivesTheRightView) {
  const Shape shape = GetParam();
  const Forest forest = makeForest(30, 6, 5);
  MatchingVolume right = buildVolume(shape, forest);
  PerThread<std::vector<std::uint8_t>> rows;
  shiftToRightView(shape.range, right, rows);
  cv::Mat mirrored_left;
  cv::Mat mirrored_right;
  cv::flip(makeGray(shape.size(), Content::kPatches, 1), mirrored_left, 1);
  cv::flip(makeGray(shape.size(), Content::kPatches, 2), mirrored_right, 1);
  // Census and Sobel differences are symmetric to the last bit. Rounding of sums does not matter,
  // because they are sums of integers.
  MatchingVolume swapped;
  VolumeBuilder().build(mirrored_right, mirrored_left, shape.range, forest, ForestEvaluator(forest),
                        swapped);
  for (int y = 0; y < shape.height; ++y) {
    for (int x = 0; x < shape.width; ++x) {
      for (int i = 0; i < shape.range.count; ++i) {
        ASSERT_EQ(swapped.pixel(y, shape.width - 1 - x)[i], right.pixel(y, x)[i])
            << "y " << y << " x " << x << " i " << i;
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Shapes, VolumeBuilderTest, testing::ValuesIn(awkwardShapes()));

}  // namespace
}  // namespace cbmv::test
