#include "selection/map_confidence.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "support/error_text.h"
#include "support/judged_maps.h"
#include "support/second_forest.h"
#include "support/simd_targets.h"

namespace cbmv::test {
namespace {

const ConfidenceForest& mapForest() {
  static const ConfidenceForest kForest = makeMapForest(3);
  return kForest;
}

void expectNaiveConfidence(const RandomMaps& maps, const MapConfidence& found) {
  const cv::Size size = maps.disparity.size();
  const cv::Mat expected =
      naiveConfidence(mapForest(), found.planes(), maps.disparity, maps.range.invalid());
  expectMap<std::uint8_t>(found.confidence(), size,
                          [&](int y, int x) { return expected.at<std::uint8_t>(y, x); });
  expectMap<std::uint8_t>(found.roughnessBins(), size, [&](int y, int x) {
    const int roughness = naiveConfidenceFeatures(found.planes(), y, x).at("roughness_5");
    return roughness < 2 ? 0 : roughness < 20 ? 1 : roughness < 200 ? 2 : 3;
  });
}

class Confidence : public testing::TestWithParam<Case> {};

TEST_P(Confidence, IsTheForestsProbability) {
  const auto [shape, view, content] = GetParam();
  const RandomMaps maps = makeJudgedMaps(shape, content, 31);
  onEverySimdTarget([&] {
    MapConfidence confidence(mapForest(), "some.forest");
    confidence.estimate(maps.judged());
    expectNaiveConfidence(maps, confidence);
  });
}

INSTANTIATE_TEST_SUITE_P(Shapes, Confidence,
                         testing::Combine(testing::ValuesIn(awkwardShapes()),
                                          testing::Values(View::kLeft),
                                          testing::Values(Content::kNoise, Content::kPatches)));

/// Requires both confident and other pixels, or the tests would be meaningless.
TEST(MapConfidence, DependsOnThePixelOnly) {
  MapConfidence confidence(mapForest(), "some.forest");
  for (const std::size_t threads : {1, 2}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    for (const Shape& shape : {Shape{30, 41, {0, 30}}, Shape{3, 700, {-5, 40}}}) {
      const RandomMaps maps = makeJudgedMaps(shape, Content::kPatches, 32);
      confidence.estimate(maps.judged());
      expectNaiveConfidence(maps, confidence);
      const int confident =
          cv::countNonZero(confidence.confidence() >= ConfidentNeighbors::kConfident);
      EXPECT_GT(confident, shape.size().area() / 5);
      EXPECT_LT(confident, shape.size().area() * 4 / 5);
    }
  }
}

TEST(MapConfidence, RejectsOtherFeatures) {
  ConfidenceForest forest = makeMapForest(3);
  forest.feature_names[4] = "something";
  EXPECT_TRUE(mentions(errorText([&] { MapConfidence(forest, "some.forest"); }),
                       {"some.forest", "confidence forest", "\"something\"", "\"border\""}));
}

}  // namespace
}  // namespace cbmv::test
