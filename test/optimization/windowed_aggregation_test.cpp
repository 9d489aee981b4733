#include "optimization/windowed_aggregation.h"

#include <algorithm>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "optimization/support_arms.h"
#include "support/random_images.h"
#include "support/random_search_space.h"
#include "support/simd_targets.h"

namespace cbmv::test {
namespace {

enum Channel { kLeft = 0, kRight = 1, kUp = 2, kDown = 3 };

struct Naive {
  const SearchSpace& space;
  const AggregatedVolume& costs;
  const SupportArms& arms;
  View view;

  bool hasHypothesis(int y, int x, int i) const {
    const SearchSpace::Tile tile = space.tile(y, x / kTileColumns);
    return std::binary_search(tile.indices, tile.indices + tile.count, i);
  }

  int arm(int y, int x, int i, Channel channel) const {
    const int match = matchingColumn(view, x, space.range().min + i);
    return std::min(arms.reference.at<cv::Vec4b>(y, x)[channel],
                    arms.other.at<cv::Vec4b>(y, match)[channel]);
  }

  /// The last pixel of a horizontal arm.
  int end(int y, int x, int i, Channel channel) const {
    const int step = channel == kLeft ? -1 : 1;
    int last = x;
    for (int k = arm(y, x, i, channel); k > 0 && hasHypothesis(y, last + step, i); --k) {
      last += step;
    }
    return last;
  }

  int mean(int y, int x, int i) const {
    if (!isInside(arms.other, y, matchingColumn(view, x, space.range().min + i))) {
      return costs.pixel(y, x)[i];
    }
    std::int64_t sum = 0;
    std::int64_t pixels = 0;
    for (int row = y - arm(y, x, i, kUp); row <= y + arm(y, x, i, kDown); ++row) {
      if (!hasHypothesis(row, x, i)) {
        continue;
      }
      for (int column = end(row, x, i, kLeft); column <= end(row, x, i, kRight); ++column) {
        sum += costs.pixel(row, column)[i];
        ++pixels;
      }
    }
    return static_cast<int>((2 * sum + pixels) / (2 * pixels));
  }
};

SupportArms makeArms(const cv::Size& size, Content content, int max_length, float threshold) {
  SupportArms arms;
  computeSupportArms(makeGray(size, content, 5), max_length, threshold, arms.reference);
  computeSupportArms(makeGray(size, content, 6), max_length, threshold, arms.other);
  arms.longest_px = max_length - 1;
  return arms;
}

SearchSpace makeExhaustiveSpace(const Shape& shape) {
  SearchSpace space;
  space.buildExhaustive(shape.height, shape.width, shape.range);
  return space;
}

/// Calls f(y, x, i, index of the hypothesis) for every hypothesis inside the image.
template <typename F>
void forHypotheses(const SearchSpace& space, const F& f) {
  for (int y = 0; y < space.height(); ++y) {
    for (int x = 0; x < space.width(); ++x) {
      const SearchSpace::Tile tile = space.tile(y, x / kTileColumns);
      for (int j = 0; j < tile.count; ++j) {
        f(y, x, tile.indices[j], (tile.first_entry + j) * kTileColumns + x % kTileColumns);
      }
    }
  }
}

/// Columns outside the image have the largest value of the type.
template <typename Cost>
void toWindows(const AggregatedVolume& costs, const SearchSpace& space,
               WindowedVolume<Cost>& windows) {
  windows.resize(space);
  std::fill_n(windows.entry(0), space.entries() * kTileColumns, static_cast<Cost>(-1));
  forHypotheses(space, [&](int y, int x, int i, std::size_t number) {
    windows.entry(0)[number] = static_cast<Cost>(costs.pixel(y, x)[i]);
  });
}

/// Compares with expected(y, x, i); stops at the first difference.
template <typename Expected>
void expectWindows(const SearchSpace& space, const WindowedAggregatedVolume& windows,
                   const Expected& expected) {
  ASSERT_EQ(windows.entries(), space.entries());
  bool equal = true;
  forHypotheses(space, [&](int y, int x, int i, std::size_t number) {
    if (equal) {
      equal = windows.entry(0)[number] == expected(y, x, i);
      EXPECT_EQ(windows.entry(0)[number], expected(y, x, i))
          << "y " << y << " x " << x << " i " << i;
    }
  });
}

void expectNaiveMeans(const SearchSpace& space, const SupportArms& arms, View view,
                      const AggregatedVolume& costs, int max_cost) {
  const Naive naive{space, costs, arms, view};
  AggregatedVolume expected(space.height(), space.width(), space.range().count);
  forHypotheses(space, [&](int y, int x, int i, std::size_t /*number*/) {
    expected.pixel(y, x)[i] = static_cast<std::uint16_t>(naive.mean(y, x, i));
  });
  const auto expect_means = [&](const WindowedAggregatedVolume& aggregated) {
    expectWindows(space, aggregated, [&](int y, int x, int i) { return expected.pixel(y, x)[i]; });
  };
  WindowedAggregatedVolume words;
  toWindows(costs, space, words);
  WindowedMatchingVolume bytes;
  toWindows(costs, space, bytes);
  WindowedAggregator aggregator;
  onEverySimdTarget([&] {
    WindowedAggregatedVolume aggregated;
    aggregator.aggregate(space, words, max_cost, arms, view, aggregated);
    expect_means(aggregated);
    if (max_cost <= 255) {
      aggregator.aggregate(space, bytes, max_cost, arms, view, aggregated);
      expect_means(aggregated);
    }
  });
}

void expectNaiveMeans(const SearchSpace& space, View view, Content content, int max_length,
                      float threshold, int max_cost) {
  const Shape shape{space.height(), space.width(), space.range()};
  expectNaiveMeans(space, makeArms(shape.size(), content, max_length, threshold), view,
                   makeCosts(shape, content, max_cost, 7), max_cost);
}

class WindowedAggregation : public testing::TestWithParam<Case> {};

TEST_P(WindowedAggregation, EqualsNaiveMeans) {
  const auto [shape, view, content] = GetParam();
  const SearchSpace space = makeSearchSpace(shape.height, shape.width, shape.range, 3);
  expectNaiveMeans(space, view, content, 6, 40.0F, 5355);
  expectNaiveMeans(space, view, content, 1, 40.0F, 255);
  expectNaiveMeans(space, view, content, 6, 300.0F, 255);
}

TEST_P(WindowedAggregation, EqualsNaiveMeansOfExhaustiveSearch) {
  const auto [shape, view, content] = GetParam();
  const SearchSpace space = makeExhaustiveSpace(shape);
  expectNaiveMeans(space, view, content, 6, 40.0F, 5355);
  expectNaiveMeans(space, view, content, 6, 300.0F, 255);
}

TEST_P(WindowedAggregation, EqualsNaiveMeansOverLongArms) {
  const auto [shape, view, content] = GetParam();
  const SearchSpace space = makeSearchSpace(shape.height, shape.width, shape.range, 4);
  expectNaiveMeans(space, view, content, 12, 300.0F, 16383);
  expectNaiveMeans(space, view, content, 19, 300.0F, 255);
}

INSTANTIATE_TEST_SUITE_P(Shapes, WindowedAggregation, allCases());

// Several blocks horizontally and vertically.
TEST(WindowedAggregation, EqualsNaiveMeansInManyBlocks) {
  for (const Shape& shape : {Shape{9, 700, {-3, 21}}, Shape{14, 75, {-40, 300}}}) {
    for (const SearchSpace& space :
         {makeSearchSpace(shape.height, shape.width, shape.range, 5), makeExhaustiveSpace(shape)}) {
      expectNaiveMeans(space, View::kLeft, Content::kNoise, 6, 300.0F, 5355);
      expectNaiveMeans(space, View::kRight, Content::kPatches, 21, 40.0F, 5355);
    }
  }
}

// The longest arms, over tiles of which every third lacks the disparity.
TEST(WindowedAggregation, EndsArmsAtGaps) {
  const Shape shape{3, 700, {0, 1}};
  SearchSpace space;
  space.build(shape.height, shape.width, shape.range, [&](int y, SearchSpace::Row& row) {
    for (int t = 0; t < space.tiles(); ++t) {
      if ((t + y) % 20 != 0) {
        row.push(0);
      }
      row.endTile();
    }
  });
  expectNaiveMeans(space, View::kLeft, Content::kNoise, 255, 300.0F, 16383);
  expectNaiveMeans(space, View::kRight, Content::kNoise, 8, 300.0F, 255);
}

// The largest costs whose sums fit into 16 bits, and the smallest that do not; arms of one pixel,
// of default length, and of maximum length.
TEST(WindowedAggregation, IsExactWhereSumsNeed16Bits) {
  for (const auto& [arm, max_cost] :
       {std::pair(1, 16383), {5, 10922}, {5, 10923}, {7, 8191}, {7, 8192}}) {
    expectNaiveMeans(makeExhaustiveSpace({41, 80, {-2, 3}}), View::kLeft, Content::kNoise, arm + 1,
                     300.0F, max_cost);
    expectNaiveMeans(makeSearchSpace(23, 40, {-2, 3}, 6), View::kRight, Content::kPatches, arm + 1,
                     300.0F, max_cost);
  }
}

// Means close to halves, for large costs and large regions, where rounding is most difficult.
TEST(WindowedAggregation, RoundsHalvesUp) {
  const Shape shape{15, 400, {0, 1}};
  const SupportArms arms = makeArms(shape.size(), Content::kNoise, 8, 300.0F);
  AggregatedVolume costs(shape.height, shape.width, 1);
  for (const int max_cost : {8191, 8190, 9, 1}) {
    for (int i = 0; i < shape.height * shape.width; ++i) {
      costs.row(0)[i] = static_cast<std::uint16_t>(max_cost - i % 2);
    }
    expectNaiveMeans(makeExhaustiveSpace(shape), arms, View::kLeft, costs, max_cost);
  }
}

// All costs have the largest value, so the sums are as large as possible.
TEST(WindowedAggregation, IsExactForTheLargestSums) {
  const Shape shape{31, 63, {0, 2}};
  AggregatedVolume costs(shape.height, shape.width, shape.range.count);
  for (const auto& [arm, max_cost] : {std::pair(3, 16383), {5, 10922}, {7, 8191}, {30, 16383}}) {
    const SupportArms arms = makeArms(shape.size(), Content::kNoise, arm + 1, 300.0F);
    std::fill_n(costs.row(0), costs.size(), static_cast<std::uint16_t>(max_cost));
    expectNaiveMeans(makeExhaustiveSpace(shape), arms, View::kLeft, costs, max_cost);
  }
}

TEST(WindowedAggregation, DoesNotDependOnThreadsOrEarlierRuns) {
  const Shape shape{33, 400, {0, 70}};
  const SupportArms arms = makeArms(shape.size(), Content::kPatches, 6, 40.0F);
  const AggregatedVolume costs = makeCosts(shape, Content::kNoise, 5355, 8);
  const auto aggregate = [&](WindowedAggregator& aggregator, const SearchSpace& space) {
    WindowedAggregatedVolume windows;
    toWindows(costs, space, windows);
    WindowedAggregatedVolume aggregated;
    aggregator.aggregate(space, windows, 5355, arms, View::kLeft, aggregated);
    AggregatedVolume dense(shape.height, shape.width, shape.range.count);
    forHypotheses(space, [&](int y, int x, int i, std::size_t number) {
      dense.pixel(y, x)[i] = aggregated.entry(0)[number];
    });
    return dense;
  };
  const SearchSpace space = makeSearchSpace(shape.height, shape.width, shape.range, 9);
  WindowedAggregator used;
  aggregate(used, makeExhaustiveSpace(shape));
  aggregate(used, makeSearchSpace(shape.height, shape.width, shape.range, 10));
  const AggregatedVolume parallel = aggregate(used, space);
  const tbb::global_control single(tbb::global_control::max_allowed_parallelism, 1);
  WindowedAggregator fresh;
  const AggregatedVolume serial = aggregate(fresh, space);
  forHypotheses(space, [&](int y, int x, int i, std::size_t /*number*/) {
    ASSERT_EQ(parallel.pixel(y, x)[i], serial.pixel(y, x)[i]);
  });
}

}  // namespace
}  // namespace cbmv::test
