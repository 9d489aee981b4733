#include "offline/pairing.h"

#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace cbmv {
namespace {

using Pairs = std::vector<std::pair<std::size_t, std::size_t>>;

std::vector<ros::Time> times(const std::vector<double>& seconds) {
  std::vector<ros::Time> stamps(seconds.size());
  std::transform(seconds.begin(), seconds.end(), stamps.begin(),
                 [](double second) { return ros::Time(second); });
  return stamps;
}

TEST(PairStamps, TakesEqualStampsInAnyOrder) {
  const StampPairs pairs = pairStamps(times({3, 1, 2}), times({1, 2.5, 3}), 0);
  EXPECT_EQ(pairs.pairs, (Pairs{{1, 0}, {0, 2}}));
  EXPECT_EQ(pairs.left_alone, (std::vector<std::size_t>{2}));
  EXPECT_EQ(pairs.right_alone, (std::vector<std::size_t>{1}));
}

TEST(PairStamps, PairsRepeatedStampsInTheOrderOfTheRecording) {
  const StampPairs pairs = pairStamps(times({0, 0, 0, 5}), times({0, 5, 0, 0}), 0);
  EXPECT_EQ(pairs.pairs, (Pairs{{0, 0}, {1, 2}, {2, 3}, {3, 1}}));
  EXPECT_TRUE(pairs.left_repeated.empty());
  EXPECT_TRUE(pairs.right_repeated.empty());
}

TEST(PairStamps, LeavesOutRepeatedStampsWithoutPartner) {
  const StampPairs pairs = pairStamps(times({1, 1, 2}), times({1, 2, 2, 2}), 0);
  EXPECT_EQ(pairs.pairs, (Pairs{{0, 0}, {2, 1}}));
  EXPECT_EQ(pairs.left_repeated, (std::vector<std::size_t>{1}));
  EXPECT_EQ(pairs.right_repeated, (std::vector<std::size_t>{2, 3}));
  EXPECT_TRUE(pairs.right_alone.empty());
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

/// Further apart than ros::Duration can say.
TEST(PairStamps, StampsMayBeACenturyApart) {
  const std::vector<ros::Time> stamps = {ros::Time(1, 0), ros::Time(4200000000, 5)};
  EXPECT_EQ(distanceNs(stamps[0], stamps[1]), 4199999999000000005);
  EXPECT_EQ(nearestStamp(stamps, ros::Time(2000000000, 0)), 0U);
  const StampPairs pairs = pairStamps(stamps, {ros::Time(2100000000, 0)}, 0.5);
  EXPECT_EQ(pairs.left_alone.size(), 2U);
}

/// Each the other's nearest, by comparing all with all.
Pairs referencePairs(const std::vector<ros::Time>& left, const std::vector<ros::Time>& right,
                     double bound_s) {
  const auto distance = [](const ros::Time& a, const ros::Time& b) {
    return std::abs((a - b).toSec());
  };
  Pairs pairs;
  for (std::size_t l = 0; l < left.size(); ++l) {
    for (std::size_t r = 0; r < right.size(); ++r) {
      bool nearest = distance(left[l], right[r]) <= bound_s;
      for (const ros::Time& other : right) {
        nearest = nearest && distance(left[l], other) >= distance(left[l], right[r]);
      }
      for (const ros::Time& other : left) {
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
