#include "optimization/windowed_winners.h"

#include <algorithm>
#include <functional>
#include <random>

#include <gtest/gtest.h>

#include "support/random_images.h"
#include "support/random_search_space.h"
#include "support/simd_targets.h"
#include "volume/windowed_right_view.h"

namespace cbmv {
namespace {

constexpr int kNone = 1 << 20;

/// A cost per hypothesis of a space, with many ties; costs outside are the lowest.
template <typename Cost>
WindowedVolume<Cost> randomCosts(const SearchSpace& space, std::uint32_t seed, int highest) {
  WindowedVolume<Cost> costs;
  costs.resize(space);
  std::mt19937 random(seed);
  for (std::size_t e = 0; e < space.entries(); ++e) {
    for (int c = 0; c < kTileColumns; ++c) {
      costs.entry(e)[c] = static_cast<Cost>(random() % static_cast<unsigned>(highest));
    }
  }
  return costs;
}

/// The cost of (x, i); kNone if it is not in the space or is outside.
template <typename Cost>
int costAt(const SearchSpace& space, const WindowedVolume<Cost>& costs, View view, int y, int x,
           int i) {
  if (x < 0 || x >= space.width()) {
    return kNone;
  }
  const int match = matchingColumn(view, x, space.range().min + i);
  const SearchSpace::Tile tile = space.tile(y, x / kTileColumns);
  const auto* end = tile.indices + tile.count;
  const auto* found = std::find(tile.indices, end, i);
  if (match < 0 || match >= space.width() || found == end) {
    return kNone;
  }
  return costs.entry(tile.first_entry +
                     static_cast<std::size_t>(found - tile.indices))[x % kTileColumns];
}

/// Index of the lowest cost in the range; −1: none.
template <typename CostOf>
int cheapest(int count, const CostOf& cost_of) {
  int best = -1;
  for (int i = 0; i < count; ++i) {
    if (cost_of(i) != kNone && (best < 0 || cost_of(i) < cost_of(best))) {
      best = i;
    }
  }
  return best;
}

void forSpaces(const std::function<void(const SearchSpace&)>& check) {
  for (const test::Shape& shape : test::awkwardShapes()) {
    SCOPED_TRACE(shape);
    check(test::makeSearchSpace(shape.height, shape.width, shape.range, 7));
    SearchSpace exhaustive;
    exhaustive.buildExhaustive(shape.height, shape.width, shape.range);
    check(exhaustive);
  }
}

template <typename Check>
void forPixels(const SearchSpace& space, const Check& check) {
  for (int y = 0; y < space.height(); ++y) {
    for (int x = 0; x < space.width(); ++x) {
      check(y, x);
    }
  }
}

TEST(WindowedWinners, EqualPlainLoopsOnEveryInstructionSet) {
  test::onEverySimdTarget([] {
    forSpaces([](const SearchSpace& space) {
      const auto costs = randomCosts<std::uint16_t>(space, 3, 40);
      for (const View view : {View::kLeft, View::kRight}) {
        cv::Mat found;
        windowedWinners(space, costs, view, found);
        forPixels(space, [&](int y, int x) {
          const int best = cheapest(space.range().count,
                                    [&](int i) { return costAt(space, costs, view, y, x, i); });
          ASSERT_EQ(found.at<float>(y, x), space.range().min + best) << view << y << ", " << x;
        });
      }
    });
  });
}

TEST(WindowedWinners, RightWinnersEqualPlainLoopsOnEveryInstructionSet) {
  test::onEverySimdTarget([] {
    PerThread<WindowedRightWinnersRow> scratch;  // reused for all cases
    forSpaces([&](const SearchSpace& space) {
      const auto costs = randomCosts<std::uint16_t>(space, 4, 40);
      cv::Mat found;
      windowedRightWinners(space, costs, scratch, found);
      forPixels(space, [&](int y, int x) {
        const int best = cheapest(space.range().count, [&](int i) {
          return costAt(space, costs, View::kLeft, y, x + space.range().min + i, i);
        });
        ASSERT_EQ(found.at<float>(y, x), space.range().min + best) << y << ", " << x;
      });
    });
  });
}

TEST(WindowedRightView, EqualsPlainLoops) {
  WindowedRightView view;  // reused for all cases
  SearchSpace right;
  WindowedMatchingVolume right_costs;
  forSpaces([&](const SearchSpace& left) {
    const auto costs = randomCosts<std::uint8_t>(left, 9, 256);
    view.build(left, costs, right, right_costs);
    const auto left_cost = [&](int y, int x, int i) {
      return costAt(left, costs, View::kLeft, y, x + left.range().min + i, i);
    };
    ASSERT_EQ(right.tiles(), left.tiles());
    for (int y = 0; y < left.height(); ++y) {
      for (int t = 0; t < right.tiles(); ++t) {
        const SearchSpace::Tile tile = right.tile(y, t);
        for (int i = 0; i < left.range().count; ++i) {
          const auto* found = std::find(tile.indices, tile.indices + tile.count, i);
          bool is_matched = false;
          for (int c = 0; c < kTileColumns && t * kTileColumns + c < left.width(); ++c) {
            const int expected = left_cost(y, t * kTileColumns + c, i);
            is_matched = is_matched || expected != kNone;
            if (found != tile.indices + tile.count) {
              const std::size_t entry =
                  tile.first_entry + static_cast<std::size_t>(found - tile.indices);
              ASSERT_EQ(right_costs.entry(entry)[c], expected == kNone ? kOutsideCost : expected);
            }
          }
          ASSERT_EQ(found != tile.indices + tile.count, is_matched) << y << " " << t << " " << i;
        }
      }
    }
  });
}

}  // namespace
}  // namespace cbmv
