#include "selection/confidence_features.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "support/judged_maps.h"
#include "support/selection_reference.h"
#include "support/simd_targets.h"

namespace cbmv::test {
namespace {

ConfidenceCodes makeCodes() {
  ConfidenceForest shape;
  shape.feature_names = confidenceFeatureNames();
  return ConfidenceCodes(shape);
}

/// Checks the pixels [x, x + count) of a row.
void expectNaiveFeatures(const MapPlanes& planes, ConfidenceFeatures& features, int y, int x,
                         int count) {
  ConfidenceCodes codes = makeCodes();
  features.code(x, count, codes);
  for (int i = 0; i < count; ++i) {
    const NamedValues expected = naiveConfidenceFeatures(planes, y, x + i);
    for (std::size_t f = 0; f < confidenceFeatureNames().size(); ++f) {
      const std::string& name = confidenceFeatureNames()[f];
      ASSERT_EQ(codes.line(static_cast<int>(f))[i] + 128, expected.at(name))
          << name << " at y " << y << " x " << x + i;
    }
  }
}

void expectNaiveFeatures(const Shape& shape, Content content, int block) {
  MapPlanes planes;
  planes.prepare(makeJudgedMaps(shape, content, 11).judged());
  onEverySimdTarget([&] {
    ConfidenceFeatures features;
    features.resize(shape.width);
    for (int y = 0; y < shape.height; ++y) {
      features.startRow(planes, y);
      for (int x = 0; x < shape.width; x += block) {
        expectNaiveFeatures(planes, features, y, x, std::min(block, shape.width - x));
      }
    }
  });
}

class Features : public testing::TestWithParam<Case> {};

TEST_P(Features, AreThoseOfThePlanes) {
  const auto [shape, view, content] = GetParam();
  expectNaiveFeatures(shape, content, ConfidenceFeatures::kBlock);
}

INSTANTIATE_TEST_SUITE_P(Shapes, Features,
                         testing::Combine(testing::ValuesIn(awkwardShapes()),
                                          testing::Values(View::kLeft),
                                          testing::Values(Content::kNoise, Content::kPatches)));

TEST(ConfidenceFeatures, DoNotDependOnTheBlocks) {
  expectNaiveFeatures({6, 3, {0, 9}}, Content::kNoise, 4);
  expectNaiveFeatures({6, 41, {-4, 30}}, Content::kPatches, 4);
  expectNaiveFeatures({2, 2 * ConfidenceFeatures::kBlock + 5, {0, 30}}, Content::kPatches,
                      ConfidenceFeatures::kBlock);
}

/// Values far above the range of a byte are clamped.
TEST(ConfidenceFeatures, OfLargeDisparitiesAreCutOff) {
  expectNaiveFeatures({9, 30, {0, 4096}}, Content::kNoise, ConfidenceFeatures::kBlock);
  expectNaiveFeatures({9, 30, {-2048, 4096}}, Content::kNoise, ConfidenceFeatures::kBlock);
}

TEST(Compressed, RisesToTheHighestMargin) {
  EXPECT_EQ(compressed(0), 0);
  EXPECT_EQ(compressed(127), 127);
  EXPECT_EQ(compressed(128), 128);
  EXPECT_EQ(compressed(144), 129);
  EXPECT_EQ(compressed(kHighestMargin - 1), 254);
  EXPECT_EQ(compressed(kHighestMargin), 255);
  EXPECT_EQ(compressed(1 << 20), 255);
}

TEST(ConfidenceFeatureNames, HaveTheRoughness) {
  EXPECT_EQ(confidenceFeatureNames().at(roughnessFeature()), ConfidenceForest::kRoughness);
}

}  // namespace
}  // namespace cbmv::test
