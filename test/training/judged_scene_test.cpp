#include "training/judged_scene.h"

#include <cmath>
#include <limits>
#include <set>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/judged_maps.h"
#include "support/second_forest.h"
#include "training/sampling.h"

namespace cbmv::test {
namespace {

constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();
constexpr long kAll = 1000000;

/// Maps with a truth that equals about half of the disparities; some are exactly 1 px off.
JudgedScene makeScene(const Shape& shape) {
  const RandomMaps maps = makeJudgedMaps(shape, Content::kPatches, 51);
  JudgedScene scene;
  scene.result.range = maps.range;
  scene.result.disparity = maps.disparity;
  scene.result.right_disparity = maps.right_disparity;
  scene.result.labels = maps.labels;
  scene.result.confidence = maps.probability;
  scene.result.margin = maps.margin;
  scene.truth = maps.disparity.clone();
  std::mt19937 random(52);
  for (int y = 0; y < shape.height; ++y) {
    for (int x = 0; x < shape.width; ++x) {
      const float error = static_cast<float>(static_cast<int>(random() % 17) - 8) / 4.0F;
      float& truth = scene.truth.at<float>(y, x);
      truth = random() % 5 == 0 ? kUnknown : truth + error;
    }
  }
  return scene;
}

struct NaiveSample {
  NamedValues features;
  int label;
  int held_out;
};

using Sortable = std::vector<int>;

/// All samples as sorted lists of numbers.
std::multiset<Sortable> sorted(const std::vector<NaiveSample>& samples,
                               const std::vector<std::string>& names) {
  std::multiset<Sortable> all;
  for (const NaiveSample& sample : samples) {
    Sortable values = {sample.label, sample.held_out};
    for (const std::string& name : names) {
      values.push_back(sample.features.at(name));
    }
    all.insert(std::move(values));
  }
  return all;
}

std::multiset<Sortable> sorted(const ConfidenceSamples& samples) {
  std::multiset<Sortable> all;
  for (long i = 0; i < samples.count(); ++i) {
    Sortable values = {samples.labels[i], samples.held_out[i]};
    for (const auto& column : samples.features) {
      values.push_back(column[i]);
    }
    all.insert(std::move(values));
  }
  return all;
}

/// Calls `use(y, x)` for the pixels that can be sampled.
template <typename Use>
void forPixels(const JudgedScene& scene, const HeldOutBand& band, const Use& use) {
  for (int y = 0; y < scene.truth.rows; ++y) {
    for (int x = 0; x < scene.truth.cols; ++x) {
      if (!band.isMargin(y) && std::isfinite(scene.truth.at<float>(y, x)) &&
          scene.result.disparity.at<float>(y, x) != scene.result.range.invalid()) {
        use(y, x);
      }
    }
  }
}

int isCorrect(double disparity, const JudgedScene& scene, int y, int x) {
  return std::fabs(disparity - scene.truth.at<float>(y, x)) <= 1 ? 1 : 0;
}

std::vector<NaiveSample> naiveConfidenceSamples(const JudgedScene& scene, std::uint64_t seed) {
  MapPlanes planes;
  planes.prepare(scene.maps());
  const HeldOutBand band(scene.truth.rows, seed);
  std::vector<NaiveSample> samples;
  forPixels(scene, band, [&](int y, int x) {
    samples.push_back({naiveConfidenceFeatures(planes, y, x),
                       isCorrect(scene.result.disparity.at<float>(y, x), scene, y, x),
                       band.contains(y) ? 1 : 0});
  });
  return samples;
}

/// Distinct proposals of a pixel, including the pixel's own within 1 px.
std::vector<int> differentProposals(const std::array<NaiveNeighbor, kSources>& proposals) {
  std::vector<int> different = {0};
  std::set<int> seen;
  for (int p = 1; p < kSources; ++p) {
    const int disparity = proposals[p].disparity;
    if (disparity != ConfidentNeighbors::kNoNeighbor &&
        std::abs(disparity - proposals[0].disparity) > 8 && seen.insert(disparity).second) {
      different.push_back(p);
    }
  }
  return different;
}

std::vector<NaiveSample> naiveSelectionSamples(const JudgedScene& scene,
                                               const ConfidenceForest& forest, std::uint64_t seed) {
  MapPlanes planes;
  planes.prepare(scene.maps());
  const float invalid = scene.result.range.invalid();
  const cv::Mat confidence = naiveConfidence(forest, planes, scene.result.disparity, invalid);
  const HeldOutBand band(scene.truth.rows, seed);
  std::vector<NaiveSample> samples;
  forPixels(scene, band, [&](int y, int x) {
    const auto proposals = naiveProposals(planes.disparity, confidence, y, x);
    for (const int p : differentProposals(proposals)) {
      const double disparity =
          p == 0 ? scene.result.disparity.at<float>(y, x) : proposals[p].disparity / 8.0;
      samples.push_back({naiveSelectionFeatures(planes, confidence, scene.result.right_disparity,
                                                invalid, y, x, p),
                         isCorrect(disparity, scene, y, x), band.contains(y) ? 1 : 0});
    }
  });
  return samples;
}

TEST(ConfidenceSamples, AreAllPixelsOfWhichTheTruthIsKnown) {
  for (const Shape& shape : {Shape{60, 37, {0, 30}}, Shape{9, 70, {-4, 20}}}) {
    const JudgedScene scene = makeScene(shape);
    for (const std::uint64_t seed : {1, 7}) {
      ConfidenceSamples samples;
      appendConfidenceSamples(scene, kAll, seed, samples);
      EXPECT_EQ(samples.feature_names, confidenceFeatureNames());
      EXPECT_EQ(sorted(samples),
                sorted(naiveConfidenceSamples(scene, seed), confidenceFeatureNames()));
    }
  }
}

TEST(SelectionSamples, AreAllDifferentProposalsOfThese) {
  const ConfidenceForest forest = makeMapForest(4);
  for (const Shape& shape : {Shape{60, 37, {0, 30}}, Shape{9, 70, {-4, 20}}}) {
    const JudgedScene scene = makeScene(shape);
    for (const std::uint64_t seed : {1, 7}) {
      ConfidenceSamples samples;
      appendSelectionSamples(scene, forest, kAll, seed, samples);
      EXPECT_EQ(samples.feature_names, selectionFeatureNames());
      EXPECT_EQ(sorted(samples),
                sorted(naiveSelectionSamples(scene, forest, seed), selectionFeatureNames()));
    }
  }
}

/// The drawn samples are a subset of all samples.
TEST(ConfidenceSamples, AreNoMoreThanAskedFor) {
  const JudgedScene scene = makeScene({60, 37, {0, 30}});
  ConfidenceSamples all;
  appendConfidenceSamples(scene, kAll, 3, all);
  ConfidenceSamples some;
  appendConfidenceSamples(scene, 200, 3, some);
  EXPECT_EQ(some.count(), 200);
  const auto of_all = sorted(all);
  const auto of_some = sorted(some);
  EXPECT_TRUE(std::includes(of_all.begin(), of_all.end(), of_some.begin(), of_some.end()));
  ConfidenceSamples others;
  appendConfidenceSamples(scene, 200, 4, others);
  EXPECT_NE(sorted(others), of_some) << "the seed decides";
}

TEST(ConfidenceSamples, AreAddedToThoseThere) {
  const JudgedScene scene = makeScene({60, 37, {0, 30}});
  ConfidenceSamples samples;
  appendConfidenceSamples(scene, 100, 3, samples);
  appendConfidenceSamples(scene, 100, 3, samples);
  EXPECT_EQ(samples.count(), 200);
  for (const auto& column : samples.features) {
    ASSERT_EQ(column.size(), 200U);
    EXPECT_EQ(column[0], column[100]);
  }
}

}  // namespace
}  // namespace cbmv::test
