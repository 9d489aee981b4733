#include "optimization/windowed_sgm.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <random>
#include <vector>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "optimization/semi_global_matching.h"
#include "optimization/surface_prior.h"
#include "support/random_images.h"
#include "support/random_search_space.h"
#include "support/simd_targets.h"

#include "cbmv_stereo/error.h"

namespace cbmv::test {
namespace {

/// Random costs up to `max_cost`; arbitrary values outside the image.
template <typename Cost>
WindowedVolume<Cost> makeWindowedCosts(const SearchSpace& space, int max_cost, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_int_distribution<int> inside(0, max_cost);
  std::uniform_int_distribution<int> beyond(0, sizeof(Cost) == 1 ? 255 : 65535);
  WindowedVolume<Cost> costs;
  costs.resize(space);
  for (int y = 0; y < space.height(); ++y) {
    for (int t = 0; t < space.tiles(); ++t) {
      const SearchSpace::Tile tile = space.tile(y, t);
      for (int i = 0; i < tile.count * kTileColumns; ++i) {
        const bool is_inside = t * kTileColumns + i % kTileColumns < space.width();
        costs.entry(tile.first_entry)[i] =
            static_cast<Cost>(is_inside ? inside(random) : beyond(random));
      }
    }
  }
  return costs;
}

/// Entry of a hypothesis; none if the tile does not have it.
std::optional<std::size_t> entryOf(const SearchSpace& space, int y, int x, int index) {
  const SearchSpace::Tile tile = space.tile(y, x / kTileColumns);
  const auto* end = tile.indices + tile.count;
  const auto* found = std::find(tile.indices, end, index);
  return found == end ? std::nullopt
                      : std::optional<std::size_t>(tile.first_entry + (found - tile.indices));
}

/// Calls visit(y, x, index, entry) for all hypotheses of the image.
template <typename Visit>
void forEntries(const SearchSpace& space, const Visit& visit) {
  for (int y = 0; y < space.height(); ++y) {
    for (int x = 0; x < space.width(); ++x) {
      const SearchSpace::Tile tile = space.tile(y, x / kTileColumns);
      for (int i = 0; i < tile.count; ++i) {
        visit(y, x, tile.indices[i], tile.first_entry + i);
      }
    }
  }
}

/// Slopes of all sizes, with holes.
cv::Mat makeSurface(const cv::Size& size, Content content) {
  std::mt19937 random(5);
  std::uniform_int_distribution<int> steps(-3, 3);
  std::uniform_int_distribution<int> lottery(1, 20);
  cv::Mat surface(size, CV_16SC1);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      const int slanted = content == Content::kNoise ? steps(random) : (2 * x - 3 * y) / 4;
      surface.at<std::int16_t>(y, x) =
          lottery(random) == 1 ? kNoSurface : static_cast<std::int16_t>(slanted);
    }
  }
  return surface;
}

struct Input {
  EdgeImages images;
  cv::Mat surface;
  View view = View::kLeft;
  SgmOptions options;
};

/// L_r of all hypotheses along one direction, directly from the formula.
class NaiveWindowedPaths {
 public:
  NaiveWindowedPaths(const SearchSpace& space, const WindowedAggregatedVolume& costs,
                     const Input& input, cv::Point direction)
      : space_(space), costs_(costs), input_(input), direction_(direction) {
    paths_.resize(space);
    const bool forward = direction.x + direction.y > 0;
    const int pixels = space.height() * space.width();
    for (int n = 0; n < pixels; ++n) {
      const int pixel = forward ? n : pixels - 1 - n;
      extend(pixel / space.width(), pixel % space.width());
    }
  }

  std::int64_t cost(std::size_t entry, int x) const {
    return paths_.entry(entry)[x % kTileColumns];
  }

 private:
  void extend(int y, int x) {
    const cv::Point previous = cv::Point(x, y) - direction_;
    const SearchSpace::Tile tile = space_.tile(y, x / kTileColumns);
    const bool first = !isInside(input_.images.reference, previous.y, previous.x) ||
                       space_.tile(previous.y, previous.x / kTileColumns).count == 0;
    for (int i = 0; i < tile.count; ++i) {
      const std::int64_t matching = costs_.entry(tile.first_entry + i)[x % kTileColumns];
      paths_.entry(tile.first_entry + i)[x % kTileColumns] = static_cast<std::uint16_t>(
          first ? matching : matching + transition(previous, {x, y}, tile.indices[i]));
    }
  }

  std::int64_t transition(cv::Point from, cv::Point to, int index) const {
    const SearchSpace::Tile tile = space_.tile(from.y, from.x / kTileColumns);
    std::int64_t lowest = cost(tile.first_entry, from.x);
    for (int i = 1; i < tile.count; ++i) {
      lowest = std::min(lowest, cost(tile.first_entry + i, from.x));
    }
    std::int64_t best = lowest + penalty(from, to, index, false);
    const int along = index - rise(from, to);
    for (const int source : {along - 1, along, along + 1}) {
      if (const auto entry = entryOf(space_, from.y, from.x, source)) {
        const std::int64_t p1 = source == along ? 0 : penalty(from, to, index, true);
        best = std::min(best, cost(*entry, from.x) + p1);
      }
    }
    return best - lowest;
  }

  int rise(cv::Point from, cv::Point to) const {
    const cv::Mat& surface = input_.surface;
    if (surface.empty() || surface.at<std::int16_t>(from) == kNoSurface ||
        surface.at<std::int16_t>(to) == kNoSurface) {
      return 0;
    }
    const int rise = surface.at<std::int16_t>(to) - surface.at<std::int16_t>(from);
    return std::abs(rise) <= 1 ? rise : 0;
  }

  std::int64_t penalty(cv::Point from, cv::Point to, int index, bool small) const {
    const EdgeImages& images = input_.images;
    const SgmOptions& options = input_.options;
    const int d = space_.range().min + index;
    const bool reference_edge = isEdge(images.reference, images.reference_threshold_gray, from, to);
    const bool other_edge = isEdge(images.other, images.other_threshold_gray,
                                   {matchingColumn(input_.view, from.x, d), from.y},
                                   {matchingColumn(input_.view, to.x, d), to.y});
    double divisor = 1;
    if (reference_edge || other_edge) {
      divisor = options.q1;
    }
    if (reference_edge && other_edge) {
      divisor *= options.q2;
    }
    if (small && direction_.y != 0) {
      divisor *= options.alpha1;
    }
    return std::lround(255.0 * (small ? options.p1 : options.p2) / divisor);
  }

  static bool isEdge(const cv::Mat& image, float threshold, cv::Point from, cv::Point to) {
    return isInside(image, from.y, from.x) && isInside(image, to.y, to.x) &&
           std::abs(image.at<std::uint8_t>(from) - image.at<std::uint8_t>(to)) >= threshold;
  }

  const SearchSpace& space_;
  const WindowedAggregatedVolume& costs_;
  const Input& input_;
  cv::Point direction_;
  WindowedAggregatedVolume paths_;
};

/// Compares the hypotheses inside the image; stops at the first difference.
void expectEqual(const SearchSpace& space, const WindowedAggregatedVolume& found,
                 const WindowedAggregatedVolume& expected) {
  ASSERT_EQ(found.entries(), expected.entries());
  bool same = true;
  forEntries(space, [&](int y, int x, int index, std::size_t entry) {
    const int column = x % kTileColumns;
    if (same && found.entry(entry)[column] != expected.entry(entry)[column]) {
      same = false;
      ADD_FAILURE() << found.entry(entry)[column] << " instead of " << expected.entry(entry)[column]
                    << " at y " << y << " x " << x << " index " << index;
    }
  });
}

WindowedAggregatedVolume naiveMeans(const SearchSpace& space, const WindowedAggregatedVolume& costs,
                                    const Input& input) {
  std::vector<NaiveWindowedPaths> paths;
  for (const cv::Point& direction :
       {cv::Point(1, 0), cv::Point(-1, 0), cv::Point(0, 1), cv::Point(0, -1)}) {
    paths.emplace_back(space, costs, input, direction);
  }
  WindowedAggregatedVolume mean;
  mean.resize(space);
  forEntries(space, [&](int /*y*/, int x, int /*index*/, std::size_t entry) {
    std::int64_t sum = 2;
    for (const NaiveWindowedPaths& path : paths) {
      sum += path.cost(entry, x);
    }
    mean.entry(entry)[x % kTileColumns] = static_cast<std::uint16_t>(sum / 4);
  });
  return mean;
}

template <typename Cost>
WindowedAggregatedVolume meansOf(WindowedSgm& sgm, const SearchSpace& space,
                                 const WindowedVolume<Cost>& costs, const Input& input) {
  WindowedAggregatedVolume mean;
  sgm.match(space, costs, input.images, input.surface, input.view, input.options, mean);
  return mean;
}

void expectNaiveMeans(const SearchSpace& space, const Input& input, int max_cost) {
  const auto words = makeWindowedCosts<std::uint16_t>(space, max_cost, 11);
  const WindowedAggregatedVolume expected = naiveMeans(space, words, input);
  WindowedSgm sgm;
  onEverySimdTarget([&] {
    expectEqual(space, meansOf(sgm, space, words, input), expected);
    if (max_cost <= 255) {
      WindowedMatchingVolume bytes;
      bytes.resize(space);
      std::copy_n(words.entry(0), space.entries() * kTileColumns, bytes.entry(0));
      expectEqual(space, meansOf(sgm, space, bytes, input), expected);
    }
  });
}

Input makeInput(const Shape& shape, View view, Content content, float reference_threshold,
                float other_threshold) {
  return {{makeGray(shape.size(), content, 9), makeGray(shape.size(), content, 10),
           reference_threshold, other_threshold},
          {},
          view,
          {}};
}

class WindowedSgmCases : public testing::TestWithParam<Case> {
 protected:
  static SearchSpace makeSpace(const Shape& shape) {
    return makeSearchSpace(shape.height, shape.width, shape.range, 21);
  }
};

TEST_P(WindowedSgmCases, EqualsNaiveOneWithDefaults) {
  const auto [shape, view, content] = GetParam();
  expectNaiveMeans(makeSpace(shape), makeInput(shape, view, content, 8.0F, 13.5F), 255);
}

TEST_P(WindowedSgmCases, EqualsNaiveOneWhereCostsOutweighPenalties) {
  const auto [shape, view, content] = GetParam();
  Input input = makeInput(shape, view, content, 60.0F, 90.2F);
  input.options.p1 = 0.13F;
  input.options.p2 = 0.31F;
  input.options.q1 = 1.7F;
  input.options.alpha1 = 2.0F;
  expectNaiveMeans(makeSpace(shape), input, 255);
}

TEST_P(WindowedSgmCases, EqualsNaiveOneAtTheBoundOfCosts) {
  const auto [shape, view, content] = GetParam();
  Input input = makeInput(shape, view, content, 0.0F, 255.5F);
  input.options.q1 = 1.0F;
  for (const float p2 : {32.0F, 64.0F}) {
    input.options.p1 = p2 - 2;
    input.options.p2 = p2;
    expectNaiveMeans(makeSpace(shape), input, 16383 - static_cast<int>(p2) * 255);
  }
}

TEST_P(WindowedSgmCases, EqualsNaiveOneAlongSurfaces) {
  const auto [shape, view, content] = GetParam();
  Input input = makeInput(shape, view, content, 8.0F, 13.5F);
  input.surface = makeSurface(shape.size(), content);
  expectNaiveMeans(makeSpace(shape), input, 255);
}

TEST_P(WindowedSgmCases, EqualsDenseOneWithExhaustiveSearch) {
  const auto [shape, view, content] = GetParam();
  Input input = makeInput(shape, view, content, 8.0F, 13.5F);
  input.surface = makeSurface(shape.size(), content);
  SearchSpace space;
  space.buildExhaustive(shape.height, shape.width, shape.range);
  const auto costs = makeWindowedCosts<std::uint16_t>(space, 4000, 11);
  AggregatedVolume dense(shape.height, shape.width, shape.range.count);
  forEntries(space, [&](int y, int x, int index, std::size_t entry) {
    dense.pixel(y, x)[index] = costs.entry(entry)[x % kTileColumns];
  });
  AggregatedVolume dense_mean;
  SemiGlobalMatcher().match(dense, input.images, input.surface, view, shape.range, input.options,
                            dense_mean);
  WindowedSgm sgm;
  const WindowedAggregatedVolume mean = meansOf(sgm, space, costs, input);
  expectVolume(dense_mean, shape, [&](int y, int x, int i) {
    return mean.entry(*entryOf(space, y, x, i))[x % kTileColumns];
  });
}

INSTANTIATE_TEST_SUITE_P(Shapes, WindowedSgmCases, allCases());

// Lists longer than one vector, with and without gaps, on every instruction set.
TEST(WindowedSgm, EqualsNaiveOneWithListsOfAllLengths) {
  const Shape shape{24, 70, {-4, 83}};
  SearchSpace space;
  space.build(shape.height, shape.width, shape.range, [&](int y, SearchSpace::Row& row) {
    for (int t = 0; t < space.tiles(); ++t) {
      const int stride = 1 + (y + t) % 4;
      const int count = std::min((shape.range.count - 1) / stride, 1 + (7 * y + 13 * t) % 83);
      for (int i = 0; i < count; ++i) {
        row.push(i * stride + (y + t) % 2);
      }
      row.endTile();
    }
  });
  Input input = makeInput(shape, View::kLeft, Content::kNoise, 80.0F, 100.0F);
  expectNaiveMeans(space, input, 255);
  input.surface = makeSurface(shape.size(), Content::kPatches);
  expectNaiveMeans(space, input, 255);
}

TEST(WindowedSgm, DoesNotDependOnThreads) {
  const Shape shape{50, 220, {0, 24}};
  const SearchSpace space = makeSearchSpace(shape.height, shape.width, shape.range, 3);
  const Input input = makeInput(shape, View::kLeft, Content::kPatches, 20, 20);
  const auto costs = makeWindowedCosts<std::uint16_t>(space, 255, 3);
  WindowedSgm sgm;
  const WindowedAggregatedVolume parallel = meansOf(sgm, space, costs, input);
  const tbb::global_control single(tbb::global_control::max_allowed_parallelism, 1);
  expectEqual(space, meansOf(sgm, space, costs, input), parallel);
}

TEST(WindowedSgm, ForgetsTheFrameBefore) {
  const Shape before{30, 130, {-3, 40}};
  const Shape shape{20, 90, {0, 19}};
  const SearchSpace space_before = makeSearchSpace(before.height, before.width, before.range, 1);
  const SearchSpace space = makeSearchSpace(shape.height, shape.width, shape.range, 2);
  Input input_before = makeInput(before, View::kRight, Content::kPatches, 20, 20);
  input_before.surface = makeSurface(before.size(), Content::kPatches);
  const Input input = makeInput(shape, View::kLeft, Content::kPatches, 20, 20);
  const auto costs = makeWindowedCosts<std::uint16_t>(space, 255, 3);
  WindowedSgm used;
  meansOf(used, space_before, makeWindowedCosts<std::uint8_t>(space_before, 255, 4), input_before);
  WindowedSgm unused;
  const WindowedAggregatedVolume expected = meansOf(unused, space, costs, input);
  expectEqual(space, meansOf(used, space, costs, input), expected);
}

TEST(WindowedSgm, TakesASpaceWithoutHypotheses) {
  const Shape shape{4, 30, {0, 8}};
  SearchSpace space;
  space.build(shape.height, shape.width, shape.range, [](int /*y*/, SearchSpace::Row& row) {
    row.endTile();
    row.endTile();
  });
  const Input input = makeInput(shape, View::kLeft, Content::kNoise, 20, 20);
  WindowedSgm sgm;
  EXPECT_EQ(meansOf(sgm, space, makeWindowedCosts<std::uint8_t>(space, 255, 3), input).entries(),
            0);
}

void expectRejected(const SgmOptions& options) {
  const Shape shape{3, 4, {0, 2}};
  const SearchSpace space = makeSearchSpace(shape.height, shape.width, shape.range, 1);
  Input input = makeInput(shape, View::kLeft, Content::kNoise, 20, 20);
  input.options = options;
  WindowedSgm sgm;
  EXPECT_THROW(meansOf(sgm, space, makeWindowedCosts<std::uint16_t>(space, 255, 3), input), Error);
}

TEST(WindowedSgm, RejectsImpossibleOptions) {
  SgmOptions options;
  options.p1 = 10.5F;
  expectRejected(options);
  options.p1 = -0.1F;
  expectRejected(options);
  options = {};
  options.p2 = 64.5F;
  expectRejected(options);
  for (float SgmOptions::*divisor : {&SgmOptions::q1, &SgmOptions::q2, &SgmOptions::alpha1}) {
    options = {};
    options.*divisor = 0.9F;
    expectRejected(options);
  }
}

}  // namespace
}  // namespace cbmv::test
