#include "selection/map_selector.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "refinement/left_right_check.h"
#include "refinement/median_filter.h"
#include "selection/thin_pixels.h"
#include "support/error_text.h"
#include "support/judged_maps.h"
#include "support/second_forest.h"
#include "support/simd_targets.h"
namespace cbmv::test {
namespace {

struct Maps {
  cv::Mat disparity;
  cv::Mat confidence;
  cv::Mat sigma;
};

/// The choice for a pixel: a proposal, in units of the planes, and its probability.
struct Choice {
  int source = 0;
  int disparity = 0;
  int probability = 0;
};

class NaiveSelector {
 public:
  NaiveSelector(const Forest& forest, const RandomMaps& maps) : forest_(forest), maps_(maps) {
    planes_.prepare(maps.judged());
    confidence_ = naiveConfidence(*forest.confidence, planes_, maps.disparity, invalid());
  }

  Maps select(bool fill) const {
    Maps selected{maps_.disparity.clone(), maps_.probability.clone(), cv::Mat()};
    selected.sigma.create(maps_.disparity.size(), CV_32FC1);
    for (int y = 0; y < maps_.disparity.rows; ++y) {
      for (int x = 0; x < maps_.disparity.cols; ++x) {
        selectPixel(y, x, fill, selected);
      }
    }
    cv::Mat padded;
    cv::Mat filtered;
    medianFilter(selected.disparity, maps_.range, 3, padded, filtered);
    return {filtered, selected.confidence, selected.sigma};
  }

 private:
  float invalid() const { return maps_.range.invalid(); }

  void selectPixel(int y, int x, bool fill, Maps& selected) const {
    const bool has_disparity = maps_.disparity.at<float>(y, x) != invalid();
    const int own = valueAt(confidence_, y, x);
    std::optional<Choice> choice;
    if (has_disparity && own >= ConfidentNeighbors::kConfident) {
      choice = Choice{0, 0, own};
    } else if (has_disparity || fill) {
      choice = choose(y, x, has_disparity, INT16_MIN);
      const int disparity = valueAt(planes_.disparity, y, x);
      if (has_disparity && choice->source != 0 && choice->disparity < disparity &&
          maps_.labels.at<std::uint8_t>(y, x) == kMatch && isThin(planes_.disparity, y, x)) {
        choice = choose(y, x, has_disparity, disparity);
      }
    }
    if (!choice.has_value()) {
      selected.confidence.at<float>(y, x) = 0;
      selected.sigma.at<float>(y, x) = NAN;
      return;
    }
    if (choice->source != 0) {
      selected.disparity.at<float>(y, x) = static_cast<float>(choice->disparity) / 8.0F;
    }
    const int roughness = naiveConfidenceFeatures(planes_, y, x).at("roughness_5");
    const auto byte = static_cast<std::uint8_t>(choice->probability);
    selected.confidence.at<float>(y, x) = static_cast<float>(byte) / 255.0F;
    selected.sigma.at<float>(y, x) = forest_.confidence->sigmaPx(
        forest_.confidence->roughnessBin(static_cast<std::uint8_t>(roughness)), byte);
  }

  /// The most probable proposal with a disparity of at least `least`, the first of several. Without
  /// proposals, the pixel's own disparity with the confidence of the confidence forest.
  std::optional<Choice> choose(int y, int x, bool has_disparity, int least) const {
    const auto proposals = naiveProposals(planes_.disparity, confidence_, y, x);
    std::optional<Choice> best;
    double best_log_odds = 0;
    bool has_new = false;
    for (int p = has_disparity ? 0 : 1; p < kSources; ++p) {
      const int disparity = proposals[p].disparity;
      const bool is_old =
          p > 0 && has_disparity && std::abs(disparity - proposals[0].disparity) <= 8;
      if (disparity == ConfidentNeighbors::kNoNeighbor || is_old) {
        continue;
      }
      has_new = has_new || p > 0;
      if (disparity < least) {
        continue;
      }
      const double log_odds = naiveLogOdds(
          *forest_.selection,
          naiveSelectionFeatures(planes_, confidence_, maps_.right_disparity, invalid(), y, x, p));
      if (!best.has_value() || log_odds > best_log_odds) {
        best = Choice{p, disparity, naiveProbabilityByte(log_odds)};
        best_log_odds = log_odds;
      }
    }
    const bool is_alone = best.has_value() && !has_new;
    return is_alone ? Choice{0, 0, valueAt(confidence_, y, x)} : best;
  }

  const Forest& forest_;
  const RandomMaps& maps_;
  MapPlanes planes_;
  cv::Mat confidence_;
};

std::shared_ptr<const Forest> makeSelecting() {
  auto forest = std::make_shared<Forest>(makeForest(3, 3, 1));
  addSecondForest(5, *forest);
  return forest;
}

/// Called as in the matcher: the input maps are modified.
Maps select(MapSelector& selector, const RandomMaps& maps, const SelectionOptions& options) {
  RandomMaps copy = maps;
  Maps selected{maps.disparity.clone(), maps.probability.clone(), cv::Mat()};
  copy.disparity = selected.disparity;
  copy.probability = selected.confidence;
  selector.select(copy.judged(), options,
                  {selected.disparity, selected.confidence, selected.sigma});
  return selected;
}

void expectSame(const Maps& found, const Maps& expected) {
  const cv::Size size = expected.disparity.size();
  expectMap<float>(found.disparity, size,
                   [&](int y, int x) { return expected.disparity.at<float>(y, x); });
  expectMap<float>(found.confidence, size,
                   [&](int y, int x) { return expected.confidence.at<float>(y, x); });
  ASSERT_EQ(found.sigma.size(), size);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      const float sigma = found.sigma.at<float>(y, x);
      const float naive = expected.sigma.at<float>(y, x);
      ASSERT_TRUE(std::isnan(naive) ? std::isnan(sigma) : sigma == naive)
          << sigma << " instead of " << naive << " at y " << y << " x " << x;
    }
  }
}

Maps select(MapSelector& selector, const RandomMaps& maps, bool fill) {
  return select(selector, maps, SelectionOptions{true, fill});
}

int countNan(const cv::Mat& map) {
  return static_cast<int>(
      std::count_if(map.begin<float>(), map.end<float>(), [](float v) { return std::isnan(v); }));
}

class Selected : public testing::TestWithParam<Case> {};

TEST_P(Selected, AreTheMostProbableProposals) {
  const auto [shape, view, content] = GetParam();
  RandomMaps maps = makeJudgedMaps(shape, content, 41);
  if (view == View::kRight) {
    maps.right_disparity.release();
  }
  const auto forest = makeSelecting();
  const NaiveSelector naive(*forest, maps);
  const std::array<Maps, 2> expected = {naive.select(false), naive.select(true)};
  onEverySimdTarget([&] {
    MapSelector selector(forest);
    for (const bool fill : {false, true}) {
      SCOPED_TRACE(fill ? "filled" : "not filled");
      expectSame(select(selector, maps, fill), expected[fill ? 1 : 0]);
    }
  });
}

INSTANTIATE_TEST_SUITE_P(Shapes, Selected, allCases());

TEST(MapSelector, DependsOnThePairOnly) {
  const auto forest = makeSelecting();
  MapSelector selector(forest);
  for (const std::size_t threads : {1, 2}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    for (const Shape& shape : {Shape{30, 141, {0, 30}}, Shape{7, 33, {-5, 40}}}) {
      const RandomMaps maps = makeJudgedMaps(shape, Content::kPatches, 42);
      expectSame(select(selector, maps, true), NaiveSelector(*forest, maps).select(true));
    }
  }
}

/// With equal scores of all proposals, only the median changes the maps.
TEST(MapSelector, KeepsThePixelsOwnOnTies) {
  auto forest = std::make_shared<Forest>(*makeSelecting());
  ConfidenceForest undecided = *forest->selection;
  undecided.trees.resize(1);
  undecided.trees[0] = {{{0, 128}}, {7, 7}};
  forest->selection = std::make_shared<ConfidenceForest>(undecided);
  MapSelector selector(forest);
  RandomMaps maps = makeJudgedMaps({20, 60, {0, 30}}, Content::kPatches, 43);
  cv::Mat padded;
  cv::Mat filtered;
  medianFilter(maps.disparity, maps.range, 3, padded, filtered);
  EXPECT_EQ(cv::countNonZero(select(selector, maps, false).disparity != filtered), 0);
}

/// A forest with only confident and improbable pixels, for which every other proposal is more
/// probable.
std::shared_ptr<const Forest> makeReplacing() {
  auto forest = std::make_shared<Forest>(*makeSelecting());
  ConfidenceForest confidence = *forest->confidence;
  confidence.leaf_unit = 1.0 / 32;
  confidence.trees.resize(1);
  confidence.trees[0] = {{{0, 128}}, {-100, 100}};  // probability
  forest->confidence = std::make_shared<ConfidenceForest>(confidence);
  ConfidenceForest selection = *forest->selection;
  selection.trees.resize(1);
  selection.trees[0] = {{{4, 30}}, {-100, 100}};  // source
  forest->selection = std::make_shared<ConfidenceForest>(selection);
  return forest;
}

/// Number of changed pixels of a pole that is 3 px wide. Its disparity is 30 px, that of the
/// background 10 px.
int replacedPolePixels(Label label, float pole_px) {
  const cv::Size size(60, 40);
  const cv::Rect pole(30, 0, 3, size.height);
  RandomMaps maps{
      cv::Mat(size, CV_32FC1, cv::Scalar(10)),    cv::Mat(),
      cv::Mat(size, CV_8UC1, cv::Scalar(kMatch)), cv::Mat(size, CV_32FC1, cv::Scalar(1)),
      cv::Mat(size, CV_16UC1, cv::Scalar(100)),   {0, 40}};
  maps.disparity(pole).setTo(pole_px);
  maps.probability(pole).setTo(0);
  maps.labels(pole).setTo(label);
  MapSelector selector(makeReplacing());
  const Maps found = select(selector, maps, false);
  return cv::countNonZero(found.disparity(pole) != pole_px);
}

TEST(MapSelector, KeepsThinObjectsOnWhichBothViewsAgree) {
  EXPECT_EQ(replacedPolePixels(kMatch, 30), 0);
  EXPECT_EQ(replacedPolePixels(kMismatch, 30), 3 * 40);
  EXPECT_EQ(replacedPolePixels(kMatch, 5), 3 * 40);  // the proposals are nearer
}

TEST(MapSelector, RecalibratesConfidenceAndSigmaAlone) {
  MapSelector selector(makeSelecting());
  const RandomMaps maps = makeJudgedMaps({20, 60, {0, 30}}, Content::kPatches, 47);
  const Maps trained = select(selector, maps, SelectionOptions{true, false});
  const Maps found = select(selector, maps, SelectionOptions{true, false, 1.5F, 2.0F, 1.25F});
  expectMap<float>(
      found.confidence, maps.disparity.size(),
      [&](int y, int x) {
        const double p = std::clamp(trained.confidence.at<float>(y, x) * 255.0, 0.5, 254.5) / 255.0;
        const bool has_disparity = trained.disparity.at<float>(y, x) != maps.range.invalid();
        return has_disparity ? 1.0 / (1.0 + std::exp(-(1.5 * std::log(p / (1.0 - p)) + 2.0))) : 0.0;
      },
      1e-5);
  EXPECT_EQ(cv::countNonZero(found.disparity != trained.disparity), 0);
  EXPECT_EQ(countNan(found.sigma), countNan(trained.sigma));
  EXPECT_GT(cv::countNonZero(found.sigma > 0), 0);
  EXPECT_EQ(cv::countNonZero((found.sigma > 0) & (found.sigma != trained.sigma * 1.25)), 0);
}

TEST(MapSelector, FillsOnlyWhenAsked) {
  MapSelector selector(makeSelecting());
  const RandomMaps maps = makeJudgedMaps({20, 60, {0, 30}}, Content::kPatches, 44);
  const cv::Mat invalid = maps.disparity == maps.range.invalid();
  ASSERT_GT(cv::countNonZero(invalid), 50);
  const Maps kept = select(selector, maps, false);
  EXPECT_EQ(cv::countNonZero((kept.disparity == maps.range.invalid()) != invalid), 0);
  EXPECT_EQ(cv::countNonZero((kept.confidence == 0) & invalid), cv::countNonZero(invalid));
  const Maps filled = select(selector, maps, true);
  EXPECT_EQ(cv::countNonZero(filled.disparity == maps.range.invalid()), 0);
  EXPECT_EQ(countNan(filled.sigma), 0);
}

TEST(MapSelector, ReplacesNothingWithoutASelectionForest) {
  auto forest = std::make_shared<Forest>(*makeSelecting());
  forest->selection = nullptr;
  MapSelector selector(forest);
  const RandomMaps maps = makeJudgedMaps({20, 60, {0, 30}}, Content::kPatches, 45);
  const Maps found = select(selector, maps, true);
  EXPECT_EQ(cv::countNonZero(found.disparity != maps.disparity), 0);
  MapPlanes planes;
  planes.prepare(maps.judged());
  const float invalid = maps.range.invalid();
  const cv::Mat expected = naiveConfidence(*forest->confidence, planes, maps.disparity, invalid);
  expectMap<float>(found.confidence, maps.disparity.size(),
                   [&](int y, int x) { return static_cast<float>(valueAt(expected, y, x)) / 255; });
  EXPECT_EQ(countNan(found.sigma), cv::countNonZero(maps.disparity == invalid));
}

TEST(MapSelector, KnowsNoStandardDeviationWithoutAModel) {
  auto forest = std::make_shared<Forest>(*makeSelecting());
  ConfidenceForest confidence = *forest->confidence;
  confidence.sigma_px.clear();
  forest->confidence = std::make_shared<ConfidenceForest>(confidence);
  MapSelector selector(forest);
  RandomMaps maps = makeJudgedMaps({20, 60, {0, 30}}, Content::kPatches, 46);
  cv::Mat sigma(3, 3, CV_32FC1, cv::Scalar(1));
  selector.select(maps.judged(), {}, {maps.disparity, maps.probability, sigma});
  EXPECT_TRUE(sigma.empty());
}

TEST(MapSelector, RejectsOtherFeatures) {
  auto forest = std::make_shared<Forest>(*makeSelecting());
  ConfidenceForest selection = *forest->selection;
  selection.feature_names.pop_back();
  forest->selection = std::make_shared<ConfidenceForest>(selection);
  EXPECT_TRUE(mentions(errorText([&] { MapSelector{forest}; }),
                       {"random.forest", "selection forest", "cbmv_train"}));
}

}  // namespace
}  // namespace cbmv::test
