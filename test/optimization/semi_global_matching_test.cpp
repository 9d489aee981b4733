#include "optimization/semi_global_matching.h"

#include <cmath>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "optimization/sgm_penalties.h"
#include "optimization/surface_prior.h"
#include "support/random_images.h"
#include "support/simd_targets.h"

#include "cbmv_stereo/error.h"

namespace cbmv::test {
namespace {

/// L_r of all hypotheses along one direction, directly from the formula.
class NaivePaths {
 public:
  NaivePaths(const AggregatedVolume& costs, const EdgeImages& images, const cv::Mat& surface,
             View view, const Shape& shape, const SgmOptions& options, cv::Point direction)
      : costs_(costs),
        images_(images),
        surface_(surface),
        view_(view),
        shape_(shape),
        options_(options),
        direction_(direction),
        paths_(costs.size()) {
    const bool forward = direction.x + direction.y > 0;
    for (int n = 0; n < shape.height * shape.width; ++n) {
      const int pixel = forward ? n : shape.height * shape.width - 1 - n;
      extend(pixel / shape.width, pixel % shape.width);
    }
  }

  std::int64_t cost(int y, int x, int i) const {
    return paths_[static_cast<std::size_t>(y * shape_.width + x) * shape_.range.count + i];
  }

 private:
  void extend(int y, int x) {
    const cv::Point previous = cv::Point(x, y) - direction_;
    const bool first = !isInside(images_.reference, previous.y, previous.x);
    for (int i = 0; i < shape_.range.count; ++i) {
      const std::int64_t matching = costs_.pixel(y, x)[i];
      paths_[static_cast<std::size_t>(y * shape_.width + x) * shape_.range.count + i] =
          first ? matching : matching + transition(previous, {x, y}, i);
    }
  }

  std::int64_t transition(cv::Point from, cv::Point to, int i) const {
    std::int64_t lowest = cost(from.y, from.x, 0);
    for (int k = 1; k < shape_.range.count; ++k) {
      lowest = std::min(lowest, cost(from.y, from.x, k));
    }
    std::int64_t best = lowest + penalty(from, to, i, false);
    const int along = i - rise(from, to);
    for (const int source : {along - 1, along, along + 1}) {
      if (source >= 0 && source < shape_.range.count) {
        const std::int64_t p1 = source == along ? 0 : penalty(from, to, i, true);
        best = std::min(best, cost(from.y, from.x, source) + p1);
      }
    }
    return best - lowest;
  }

  int rise(cv::Point from, cv::Point to) const {
    if (surface_.empty() || surface_.at<std::int16_t>(from) == kNoSurface ||
        surface_.at<std::int16_t>(to) == kNoSurface) {
      return 0;
    }
    const int rise = surface_.at<std::int16_t>(to) - surface_.at<std::int16_t>(from);
    return std::abs(rise) <= 1 ? rise : 0;
  }

  std::int64_t penalty(cv::Point from, cv::Point to, int i, bool small) const {
    const int d = shape_.range.min + i;
    const bool reference_edge =
        isEdge(images_.reference, images_.reference_threshold_gray, from, to);
    const bool other_edge =
        isEdge(images_.other, images_.other_threshold_gray,
               {matchingColumn(view_, from.x, d), from.y}, {matchingColumn(view_, to.x, d), to.y});
    double divisor = 1;
    if (reference_edge || other_edge) {
      divisor = options_.q1;
    }
    if (reference_edge && other_edge) {
      divisor *= options_.q2;
    }
    if (small && direction_.y != 0) {
      divisor *= options_.alpha1;
    }
    return std::lround(255.0 * (small ? options_.p1 : options_.p2) / divisor);
  }

  static bool isEdge(const cv::Mat& image, float threshold, cv::Point from, cv::Point to) {
    return isInside(image, from.y, from.x) && isInside(image, to.y, to.x) &&
           std::abs(image.at<std::uint8_t>(from) - image.at<std::uint8_t>(to)) >= threshold;
  }

  const AggregatedVolume& costs_;
  const EdgeImages& images_;
  const cv::Mat& surface_;
  View view_;
  Shape shape_;
  SgmOptions options_;
  cv::Point direction_;
  std::vector<std::int64_t> paths_;
};

void expectNaiveMeans(const Shape& shape, View view, Content content, const SgmOptions& options,
                      int max_cost, float reference_threshold, float other_threshold,
                      const cv::Mat& surface = {}) {
  const EdgeImages images{makeGray(shape.size(), content, 9), makeGray(shape.size(), content, 10),
                          reference_threshold, other_threshold};
  const AggregatedVolume costs = makeCosts(shape, content, max_cost, 11);
  std::vector<NaivePaths> paths;
  for (const cv::Point& direction :
       {cv::Point(1, 0), cv::Point(-1, 0), cv::Point(0, 1), cv::Point(0, -1)}) {
    paths.emplace_back(costs, images, surface, view, shape, options, direction);
  }
  const auto expect_means = [&](const AggregatedVolume& mean) {
    expectVolume(mean, shape, [&](int y, int x, int i) {
      return (paths[0].cost(y, x, i) + paths[1].cost(y, x, i) + paths[2].cost(y, x, i) +
              paths[3].cost(y, x, i) + 2) /
             4;
    });
  };
  SemiGlobalMatcher matcher;
  onEverySimdTarget([&] {
    AggregatedVolume mean;
    matcher.match(costs, images, surface, view, shape.range, options, mean);
    expect_means(mean);
    if (max_cost <= 255) {
      MatchingVolume bytes(shape.height, shape.width, shape.range.count);
      std::copy_n(costs.row(0), costs.size(), bytes.row(0));
      matcher.match(bytes, images, surface, view, shape.range, options, mean);
      expect_means(mean);
    }
  });
}

class SemiGlobalMatching : public testing::TestWithParam<Case> {};

TEST_P(SemiGlobalMatching, EqualsNaiveOneWithDefaults) {
  const auto [shape, view, content] = GetParam();
  expectNaiveMeans(shape, view, content, {}, 255, 8.0F, 13.5F);
}

TEST_P(SemiGlobalMatching, EqualsNaiveOneWhereCostsOutweighPenalties) {
  const auto [shape, view, content] = GetParam();
  SgmOptions options;
  options.p1 = 0.13F;
  options.p2 = 0.31F;
  options.q1 = 1.7F;
  options.alpha1 = 2.0F;
  expectNaiveMeans(shape, view, content, options, 255, 60.0F, 90.2F);
}

TEST_P(SemiGlobalMatching, EqualsNaiveOneAtTheBoundOfCosts) {
  const auto [shape, view, content] = GetParam();
  SgmOptions options;
  options.p1 = 30.0F;
  options.p2 = 32.0F;
  options.q1 = 1.0F;
  expectNaiveMeans(shape, view, content, options, 16383 - 32 * 255, 0.0F, 255.5F);
}

/// Slopes of all sizes, with holes.
cv::Mat makeSurface(const Shape& shape, Content content) {
  std::mt19937 random(5);
  std::uniform_int_distribution<int> steps(-3, 3);
  std::uniform_int_distribution<int> lottery(1, 20);
  cv::Mat surface(shape.size(), CV_16SC1);
  for (int y = 0; y < shape.height; ++y) {
    for (int x = 0; x < shape.width; ++x) {
      const int slanted = content == Content::kNoise ? steps(random) : (2 * x - 3 * y) / 4;
      surface.at<std::int16_t>(y, x) =
          lottery(random) == 1 ? kNoSurface : static_cast<std::int16_t>(slanted);
    }
  }
  return surface;
}

TEST_P(SemiGlobalMatching, EqualsNaiveOneAlongSurfaces) {
  const auto [shape, view, content] = GetParam();
  expectNaiveMeans(shape, view, content, {}, 255, 8.0F, 13.5F, makeSurface(shape, content));
}

TEST(SemiGlobalMatching, FollowsASlantedSurfaceForNothing) {
  // Textureless between two columns with a clear disparity.
  const Shape shape{5, 31, {0, 32}};
  MatchingVolume costs(shape.height, shape.width, shape.range.count);
  cv::Mat surface(shape.size(), CV_16SC1);
  for (int y = 0; y < shape.height; ++y) {
    for (int x = 0; x < shape.width; ++x) {
      surface.at<std::int16_t>(y, x) = static_cast<std::int16_t>(100 + x / 2);
      for (int i = 0; i < shape.range.count; ++i) {
        const bool known = x == 0 || x == shape.width - 1;
        costs.pixel(y, x)[i] = known && i != 3 + x / 2 ? 255 : 0;
      }
    }
  }
  const cv::Mat gray = cv::Mat::zeros(shape.size(), CV_8UC1);
  AggregatedVolume mean;
  SemiGlobalMatcher().match(costs, {gray, gray, 1, 1}, surface, View::kLeft, shape.range, {}, mean);
  for (int x = 0; x < shape.width; ++x) {
    const auto* pixel = mean.pixel(2, x);
    EXPECT_EQ(std::min_element(pixel, pixel + shape.range.count) - pixel, 3 + x / 2) << "x " << x;
  }
}

INSTANTIATE_TEST_SUITE_P(Shapes, SemiGlobalMatching, allCases());

TEST(SemiGlobalMatching, DoesNotDependOnThreads) {
  const Shape shape{50, 120, {0, 24}};
  const EdgeImages images{makeGray(shape.size(), Content::kPatches, 1),
                          makeGray(shape.size(), Content::kPatches, 2), 20, 20};
  const AggregatedVolume costs = makeCosts(shape, Content::kNoise, 255, 3);
  AggregatedVolume parallel;
  SemiGlobalMatcher().match(costs, images, {}, View::kLeft, shape.range, {}, parallel);
  const tbb::global_control single(tbb::global_control::max_allowed_parallelism, 1);
  AggregatedVolume serial;
  SemiGlobalMatcher().match(costs, images, {}, View::kLeft, shape.range, {}, serial);
  expectVolume(parallel, shape, [&](int y, int x, int i) { return serial.pixel(y, x)[i]; });
}

TEST(SemiGlobalMatching, ForgetsTheSurfaceOfTheFrameBefore) {
  const Shape shape{20, 90, {0, 9}};
  const EdgeImages images{makeGray(shape.size(), Content::kPatches, 1),
                          makeGray(shape.size(), Content::kPatches, 2), 20, 20};
  const AggregatedVolume costs = makeCosts(shape, Content::kNoise, 255, 3);
  const auto mean_of = [&](SemiGlobalMatcher& matcher, const cv::Mat& surface) {
    AggregatedVolume mean;
    matcher.match(costs, images, surface, View::kLeft, shape.range, {}, mean);
    return mean;
  };
  SemiGlobalMatcher used;
  mean_of(used, makeSurface(shape, Content::kPatches));
  const AggregatedVolume found = mean_of(used, {});
  SemiGlobalMatcher unused;
  const AggregatedVolume expected = mean_of(unused, {});
  expectVolume(found, shape, [&](int y, int x, int i) { return expected.pixel(y, x)[i]; });
}

void expectRejected(const SgmOptions& options) {
  const Shape shape{3, 4, {0, 2}};
  const cv::Mat gray = cv::Mat::zeros(shape.size(), CV_8UC1);
  const AggregatedVolume costs = makeCosts(shape, Content::kNoise, 255, 1);
  AggregatedVolume mean;
  EXPECT_THROW(SemiGlobalMatcher().match(costs, {gray, gray, 1, 1}, {}, View::kLeft, shape.range,
                                         options, mean),
               Error);
}

TEST(SemiGlobalMatching, RejectsImpossibleOptions) {
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

TEST(SgmCostBound, AddsP2PerRun) {
  SgmOptions options;
  options.p2 = 10.0F;
  EXPECT_EQ(sgmCostBound(options), 255 + 2 * 2550);
  options.iterations = 0;
  EXPECT_EQ(sgmCostBound(options), 255);
  options.iterations = 1000;
  options.p2 = 1e9F;
  EXPECT_GT(sgmCostBound(options), 16383);
}

// The bound is about the results: no iteration adds more than P2.
TEST(SgmCostBound, HoldsOverTwoRuns) {
  const Shape shape{20, 30, {0, 9}};
  const EdgeImages images{makeGray(shape.size(), Content::kNoise, 1),
                          makeGray(shape.size(), Content::kNoise, 2), 256, 256};
  SgmOptions options;
  options.p1 = options.p2 = 0.5F;
  const AggregatedVolume costs = makeCosts(shape, Content::kNoise, 255, 3);
  AggregatedVolume once;
  AggregatedVolume twice;
  SemiGlobalMatcher().match(costs, images, {}, View::kLeft, shape.range, options, once);
  SemiGlobalMatcher().match(once, images, {}, View::kLeft, shape.range, options, twice);
  const int highest = *std::max_element(twice.row(0), twice.row(0) + twice.size());
  EXPECT_LE(highest, sgmCostBound(options));
  EXPECT_GT(highest, 255);
}

}  // namespace
}  // namespace cbmv::test
