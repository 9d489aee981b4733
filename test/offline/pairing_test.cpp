#include "offline/pairing.h"

#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace cbmv {
namespace {

using Pairs = std::vector<std::pair<std::size_t, std::size_t>>;

/// By default, all images of one camera are recorded before those of the other; `place` changes
/// this.
std::vector<StampedImage> times(const std::vector<double>& seconds) {
  std::vector<StampedImage> images(seconds.size());
  std::transform(seconds.begin(), seconds.end(), images.begin(),
                 [place = std::size_t{0}](double second) mutable {
                   return StampedImage{ros::Time(second), place++};
                 });
  return images;
}

/// Images with the same stamp at these places of the bag.
std::vector<StampedImage> ofOneStamp(const std::vector<std::size_t>& places) {
  std::vector<StampedImage> images;
  for (const std::size_t place : places) {
    images.push_back({ros::Time(0), place});
  }
  return images;
}

TEST(PairStamps, TakesEqualStampsInAnyOrder) {
  const StampPairs pairs = pairStamps(times({3, 1, 2}), times({1, 2.5, 3}), 0);
  EXPECT_EQ(pairs.pairs, (Pairs{{1, 0}, {0, 2}}));
  EXPECT_EQ(pairs.left_alone, (std::vector<std::size_t>{2}));
  EXPECT_EQ(pairs.right_alone, (std::vector<std::size_t>{1}));
}

TEST(PairStamps, PairsEqualStampsInTheOrderOfTheRecording) {
  const StampPairs pairs = pairStamps(ofOneStamp({0, 3, 4}), ofOneStamp({1, 2, 5}), 0);
  EXPECT_EQ(pairs.pairs, (Pairs{{0, 0}, {1, 1}, {2, 2}}));
  EXPECT_TRUE(pairs.left_repeated.empty());
  EXPECT_TRUE(pairs.right_repeated.empty());
}

/// As in the node: the next image replaces the one whose partner was lost.
TEST(PairStamps, LostRightImageDoesNotShiftThoseAfterIt) {
  // Left images 0, 1, 2, 3 and the right images of 0, 2 and 3.
  const StampPairs pairs = pairStamps(ofOneStamp({0, 2, 3, 5}), ofOneStamp({1, 4, 6}), 0);
  EXPECT_EQ(pairs.pairs, (Pairs{{0, 0}, {2, 1}, {3, 2}}));
  EXPECT_EQ(pairs.left_repeated, (std::vector<std::size_t>{1}));
  EXPECT_TRUE(pairs.left_alone.empty());
}

/// Occurs in split bags that overlap.
TEST(PairStamps, MessagesThatAreThereTwiceArePairedOnce) {
  const StampPairs pairs = pairStamps(ofOneStamp({0, 1}), ofOneStamp({2, 3}), 0);
  EXPECT_EQ(pairs.pairs, (Pairs{{1, 0}}));
  EXPECT_EQ(pairs.left_repeated, (std::vector<std::size_t>{0}));
  EXPECT_EQ(pairs.right_repeated, (std::vector<std::size_t>{1}));
}

TEST(PairStamps, NothingMayBeThere) {
  EXPECT_EQ(pairStamps({}, times({1}), 1).right_alone.size(), 1U);
  EXPECT_EQ(pairStamps(times({1}), {}, 1).left_alone.size(), 1U);
  EXPECT_TRUE(pairStamps({}, {}, 1).pairs.empty());
}

TEST(PairStamps, BoundIsPartOfTheRange) {
  EXPECT_EQ(pairStamps(times({1}), times({1.25}), 0.25).pairs.size(), 1U);
  EXPECT_EQ(pairStamps(times({1}), times({1.25}), 0.2).pairs.size(), 0U);
}

/// The difference exceeds the range of ros::Duration.
TEST(PairStamps, StampsMayBeACenturyApart) {
  const std::vector<ros::Time> stamps = {ros::Time(1, 0), ros::Time(4200000000, 5)};
  EXPECT_EQ(distanceNs(stamps[0], stamps[1]), 4199999999000000005);
  EXPECT_EQ(nearestStamp(stamps, ros::Time(2000000000, 0)), 0U);
  const std::vector<StampedImage> left = {{stamps[0], 0}, {stamps[1], 1}};
  const StampPairs pairs = pairStamps(left, {{ros::Time(2100000000, 0), 2}}, 0.5);
  EXPECT_EQ(pairs.left_alone.size(), 2U);
}

/// Mutually nearest images, found by comparing all with all.
Pairs referencePairs(const std::vector<StampedImage>& left, const std::vector<StampedImage>& right,
                     double bound_s) {
  const auto distance = [](const StampedImage& a, const StampedImage& b) {
    return std::abs((a.stamp - b.stamp).toSec());
  };
  Pairs pairs;
  for (std::size_t l = 0; l < left.size(); ++l) {
    for (std::size_t r = 0; r < right.size(); ++r) {
      bool nearest = distance(left[l], right[r]) <= bound_s;
      for (const StampedImage& other : right) {
        nearest = nearest && distance(left[l], other) >= distance(left[l], right[r]);
      }
      for (const StampedImage& other : left) {
        nearest = nearest && distance(other, right[r]) >= distance(left[l], right[r]);
      }
      if (nearest) {
        pairs.emplace_back(l, r);
      }
    }
  }
  return pairs;
}

TEST(PairStamps, PairsAreMutuallyNearest) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> second(0, 20);
  std::vector<double> left(80);
  std::vector<double> right(90);
  for (std::vector<double>* seconds : {&left, &right}) {
    for (double& value : *seconds) {
      value = 100 + second(random);
    }
  }
  std::sort(left.begin(), left.end());
  const Pairs expected = referencePairs(times(left), times(right), 0.07);
  ASSERT_GT(expected.size(), 10U);
  ASSERT_LT(expected.size(), 70U);
  EXPECT_EQ(pairStamps(times(left), times(right), 0.07).pairs, expected);
}

}  // namespace
}  // namespace cbmv
