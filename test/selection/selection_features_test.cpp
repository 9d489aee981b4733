#include "selection/selection_features.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "support/judged_maps.h"
#include "support/selection_reference.h"
#include "support/simd_targets.h"

namespace cbmv::test {
namespace {

constexpr int kBlock = SelectionFeatures::kBlock;
constexpr int kSlot = 1;

/// Maps and the data computed from them.
struct Example {
  Example(const Shape& shape, Content content)
      : maps(makeJudgedMaps(shape, content, 21)),
        confidence(makeConfidence(shape.size(), content, 22)) {
    planes.prepare(maps.judged());
    confidence_planes.prepare(planes, confidence);
  }

  const float* right(int y) const {
    return maps.right_disparity.empty() ? nullptr : maps.right_disparity.ptr<float>(y);
  }

  RandomMaps maps;
  cv::Mat confidence;
  MapPlanes planes;
  ConfidencePlanes confidence_planes;
};

void expectNaiveProposal(const Example& example, int y, int x, int source, int query,
                         ConfidenceCodes& codes) {
  const NamedValues expected =
      naiveSelectionFeatures(example.planes, example.confidence, example.maps.right_disparity,
                             example.maps.range.invalid(), y, x, source);
  for (std::size_t f = 0; f < selectionFeatureNames().size(); ++f) {
    const std::string& name = selectionFeatureNames()[f];
    ASSERT_EQ(codes.line(static_cast<int>(f))[query] + 128, expected.at(name))
        << name << " of source " << source << " at y " << y << " x " << x;
  }
}

/// Checks the pixels [x, x + count) of a row.
void expectNaiveFeatures(const Example& example, SelectionFeatures& features, int y, int x,
                         int count) {
  ConfidenceForest shape;
  shape.feature_names = selectionFeatureNames();
  ConfidenceCodes codes(shape);
  SelectionFeatures::Proposals proposals{};
  features.propose(x, count, proposals);
  features.code(x, count, proposals, kSlot, codes);
  for (int i = 0; i < count; ++i) {
    const auto expected = naiveProposals(example.planes.disparity, example.confidence, y, x + i);
    for (int p = 0; p < kSources; ++p) {
      ASSERT_EQ(proposals[p][i], expected[p].disparity) << "y " << y << " x " << x + i;
      if (expected[p].disparity != ConfidentNeighbors::kNoNeighbor) {
        expectNaiveProposal(example, y, x + i, p, SelectionFeatures::query(p, kSlot, i), codes);
      }
    }
  }
}

void expectNaiveFeatures(const Example& example, int block) {
  const cv::Size size = example.confidence.size();
  SelectionFeatures features;
  features.resize(size.width);
  for (int y = 0; y < size.height; ++y) {
    features.startRow(example.planes, example.confidence_planes, example.right(y),
                      example.maps.range.invalid(), y);
    for (int x = 0; x < size.width; x += block) {
      expectNaiveFeatures(example, features, y, x, std::min(block, size.width - x));
    }
  }
}

class Proposals : public testing::TestWithParam<Case> {};

TEST_P(Proposals, HaveTheFeaturesOfTheMaps) {
  const auto [shape, view, content] = GetParam();
  const Example example(shape, content);
  onEverySimdTarget([&] { expectNaiveFeatures(example, kBlock); });
}

INSTANTIATE_TEST_SUITE_P(Shapes, Proposals,
                         testing::Combine(testing::ValuesIn(awkwardShapes()),
                                          testing::Values(View::kLeft),
                                          testing::Values(Content::kNoise, Content::kPatches)));

TEST(SelectionFeatures, DoNotDependOnTheBlocks) {
  expectNaiveFeatures(Example({7, 3, {0, 9}}, Content::kNoise), 4);
  expectNaiveFeatures(Example({7, 53, {-4, 30}}, Content::kPatches), 4);
  expectNaiveFeatures(Example({3, 2 * kBlock, {0, 30}}, Content::kPatches), kBlock);
}

TEST(SelectionFeatures, DoWithoutTheRightView) {
  Example example({7, 53, {-4, 30}}, Content::kPatches);
  example.maps.right_disparity.release();
  expectNaiveFeatures(example, kBlock);
}

TEST(SelectionFeatures, HaveNoWeightsWithoutConfidence) {
  Example example({7, 20, {0, 9}}, Content::kPatches);
  example.confidence.setTo(0);
  example.confidence_planes.prepare(example.planes, example.confidence);
  expectNaiveFeatures(example, kBlock);
}

/// Values far above the range of a byte are clamped.
TEST(SelectionFeatures, OfLargeDisparitiesAreCutOff) {
  expectNaiveFeatures(Example({9, 60, {0, 4096}}, Content::kNoise), kBlock);
  expectNaiveFeatures(Example({9, 60, {-2048, 4096}}, Content::kPatches), kBlock);
}

}  // namespace
}  // namespace cbmv::test
