#include "optimization/windowed_winner_maps.h"

#include <algorithm>
#include <cstdlib>
#include <limits>

#include <gtest/gtest.h>

#include "optimization/winner_takes_all.h"
#include "refinement/subpixel.h"
#include "support/random_images.h"
#include "support/random_search_space.h"
#include "support/simd_targets.h"

namespace cbmv::test {
namespace {

/// Random costs up to `max_cost`, also outside the image.
template <typename Cost>
WindowedVolume<Cost> makeWindowedCosts(const SearchSpace& space, int max_cost, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_int_distribution<int> noise(0, max_cost);
  WindowedVolume<Cost> costs;
  costs.resize(space);
  std::generate_n(costs.entry(0), space.entries() * kTileColumns,
                  [&] { return static_cast<Cost>(noise(random)); });
  return costs;
}

/// The cost of a hypothesis; null if the space does not have it or its match is outside.
template <typename Cost>
const Cost* findCost(const SearchSpace& space, const WindowedVolume<Cost>& costs, int y, int x,
                     int d) {
  const SearchSpace::Tile tile = space.tile(y, x / kTileColumns);
  const int match = matchingColumn(View::kLeft, x, d);
  for (int k = 0; k < tile.count && match >= 0 && match < space.width(); ++k) {
    if (space.range().min + tile.indices[k] == d) {
      return costs.entry(tile.first_entry + k) + x % kTileColumns;
    }
  }
  return nullptr;
}

int naiveWinner(const SearchSpace& space, const WindowedAggregatedVolume& costs, int y, int x) {
  int winner = space.range().min - 1;
  int lowest = std::numeric_limits<int>::max();
  for (int d = space.range().min; d <= space.range().max(); ++d) {
    const std::uint16_t* cost = findCost(space, costs, y, x, d);
    if (cost != nullptr && *cost < lowest) {
      lowest = *cost;
      winner = d;
    }
  }
  return winner;
}

float naiveSubpixel(const SearchSpace& space, const WindowedAggregatedVolume& costs, int y, int x) {
  const int d = naiveWinner(space, costs, y, x);
  const std::uint16_t* before = findCost(space, costs, y, x, d - 1);
  const std::uint16_t* here = findCost(space, costs, y, x, d);
  const std::uint16_t* after = findCost(space, costs, y, x, d + 1);
  if (before == nullptr || here == nullptr || after == nullptr) {
    return static_cast<float>(d);
  }
  const int curvature = *before - 2 * *here + *after;
  return static_cast<float>(d) + (curvature == 0 ? 0.0F
                                                 : static_cast<float>(*before - *after) /
                                                       static_cast<float>(2 * curvature));
}

float naiveConfidence(const SearchSpace& space, const WindowedAggregatedVolume& costs,
                      const WindowedMatchingVolume& matching_costs, int y, int x) {
  const std::uint8_t* cost = findCost(space, matching_costs, y, x, naiveWinner(space, costs, y, x));
  return cost == nullptr ? 0.0F : 1.0F - static_cast<float>(*cost) / 255.0F;
}

std::uint16_t naiveMargin(const SearchSpace& space, const WindowedAggregatedVolume& costs, int y,
                          int x) {
  const int winner = naiveWinner(space, costs, y, x);
  int second = 65535;
  for (int d = space.range().min; d <= space.range().max(); ++d) {
    const std::uint16_t* cost = findCost(space, costs, y, x, d);
    if (cost != nullptr && std::abs(d - winner) > 1) {
      second = std::min<int>(second, *cost);
    }
  }
  const std::uint16_t* lowest = findCost(space, costs, y, x, winner);
  return lowest == nullptr || second == 65535 ? kNoMargin
                                              : static_cast<std::uint16_t>(second - *lowest);
}

struct Maps {
  cv::Mat winners, disparity, confidence, margin;
};

Maps makeNaiveMaps(const SearchSpace& space, const WindowedAggregatedVolume& costs,
                   const WindowedMatchingVolume& matching_costs) {
  Maps maps;
  for (cv::Mat* map : {&maps.winners, &maps.disparity, &maps.confidence}) {
    map->create(space.height(), space.width(), CV_32FC1);
  }
  maps.margin.create(space.height(), space.width(), CV_16UC1);
  for (int y = 0; y < space.height(); ++y) {
    for (int x = 0; x < space.width(); ++x) {
      maps.margin.at<std::uint16_t>(y, x) = naiveMargin(space, costs, y, x);
      maps.winners.at<float>(y, x) = static_cast<float>(naiveWinner(space, costs, y, x));
      maps.disparity.at<float>(y, x) = naiveSubpixel(space, costs, y, x);
      maps.confidence.at<float>(y, x) = naiveConfidence(space, costs, matching_costs, y, x);
    }
  }
  return maps;
}

template <typename Value>
void expectEqual(const cv::Mat& found, const cv::Mat& expected) {
  expectMap<Value>(found, expected.size(), [&](int y, int x) { return expected.at<Value>(y, x); });
}

/// Compares the maps with and without subpixel refinement.
void expectMaps(const SearchSpace& space, const WindowedAggregatedVolume& costs,
                const WindowedMatchingVolume& matching_costs, const Maps& expected) {
  onEverySimdTarget([&] {
    for (const bool subpixel : {false, true}) {
      Maps found;
      windowedWinnerMaps(space, costs, matching_costs, subpixel,
                         {found.winners, found.disparity, found.confidence, found.margin});
      expectEqual<float>(found.winners, expected.winners);
      expectEqual<float>(found.disparity, subpixel ? expected.disparity : expected.winners);
      expectEqual<float>(found.confidence, expected.confidence);
      expectEqual<std::uint16_t>(found.margin, expected.margin);
    }
  });
}

class WindowedWinnerMaps : public testing::TestWithParam<Shape> {};

TEST_P(WindowedWinnerMaps, EqualNaiveOnes) {
  const Shape shape = GetParam();
  for (const bool exhaustive : {false, true}) {
    SearchSpace space = makeSearchSpace(shape.height, shape.width, shape.range, 5);
    if (exhaustive) {
      space.buildExhaustive(shape.height, shape.width, shape.range);
    }
    const auto matching_costs = makeWindowedCosts<std::uint8_t>(space, 255, 6);
    for (const int max_cost : {0, 1, 3, 255, 65535}) {  // small ones cause many ties
      auto costs = makeWindowedCosts<std::uint16_t>(space, max_cost, 7);
      expectMaps(space, costs, matching_costs, makeNaiveMaps(space, costs, matching_costs));
      std::for_each(costs.entry(0), costs.entry(space.entries()),
                    [&](std::uint16_t& cost) { cost = static_cast<std::uint16_t>(~cost); });
      expectMaps(space, costs, matching_costs, makeNaiveMaps(space, costs, matching_costs));
    }
  }
}

TEST_P(WindowedWinnerMaps, EqualDenseOnesOfAnExhaustiveSpace) {
  const Shape shape = GetParam();
  SearchSpace space;
  space.buildExhaustive(shape.height, shape.width, shape.range);
  const AggregatedVolume dense = makeCosts(shape, Content::kPatches, 5355, 8);
  auto costs = makeWindowedCosts<std::uint16_t>(space, 0, 0);
  for (int y = 0; y < shape.height; ++y) {
    for (int x = 0; x < shape.width; ++x) {
      for (int i = 0; i < shape.range.count; ++i) {
        costs.entry(space.tile(y, x / kTileColumns).first_entry + i)[x % kTileColumns] =
            dense.pixel(y, x)[i];
      }
    }
  }
  const auto matching_costs = makeWindowedCosts<std::uint8_t>(space, 255, 9);
  Maps expected = makeNaiveMaps(space, costs, matching_costs);
  winnerTakesAll(dense, View::kLeft, shape.range, expected.winners);
  winnerMargins(dense, shape.range, expected.winners, expected.margin);
  expected.winners.copyTo(expected.disparity);
  refineSubpixel(dense, View::kLeft, shape.range, expected.disparity);
  expectMaps(space, costs, matching_costs, expected);
}

INSTANTIATE_TEST_SUITE_P(Shapes, WindowedWinnerMaps, testing::ValuesIn(awkwardShapes()));

}  // namespace
}  // namespace cbmv::test
