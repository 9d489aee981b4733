#include "search/range_tracker.h"

#include <gtest/gtest.h>

#include "evaluation/rendered_scene.h"
#include "search/range_source.h"

namespace cbmv {
namespace {

class Tracker : public testing::Test {
 protected:
  int add(int count, int times = 1) {
    for (int i = 0; i < times; ++i) {
      tracker_.add({0, count});
    }
    return tracker_.range()->count;
  }

  RangeTracker tracker_;
};

TEST_F(Tracker, BeginsWithTheFirstMeasurement) {
  EXPECT_EQ(tracker_.range(), std::nullopt);
  EXPECT_EQ(add(80), 80);
}

TEST_F(Tracker, WidensAtOnce) {
  add(80);
  EXPECT_EQ(add(96), 96);
  EXPECT_EQ(add(208), 208);
}

TEST_F(Tracker, ShrinksAfterManyMeasurementsToTheWidestOfThem) {
  add(160);
  EXPECT_EQ(add(64), 160);
  EXPECT_EQ(add(96), 160);
  EXPECT_EQ(add(48, RangeTracker::kMeasurementsToShrink - 3), 160);
  EXPECT_EQ(add(48), 96);
  EXPECT_EQ(add(48, RangeTracker::kMeasurementsToShrink), 48) << "begins to count anew";
}

TEST_F(Tracker, KeepsARangeThatIsNeededNowAndThen) {
  add(160);
  for (int i = 0; i < 10; ++i) {
    EXPECT_EQ(add(64, RangeTracker::kMeasurementsToShrink - 1), 160);
    EXPECT_EQ(add(160), 160);
  }
}

TEST_F(Tracker, KeepsARangeThatIsLittleTooWide) {
  add(160);
  EXPECT_EQ(add(128, 5 * RangeTracker::kMeasurementsToShrink), 160);
}

TEST_F(Tracker, BeginsAnewWithAnotherLowestDisparity) {
  add(160);
  tracker_.add({-8, 64});
  EXPECT_EQ(tracker_.range(), (DisparityRange{-8, 64}));
}

GrayPair pairOfWidth(int width) {
  const RenderedScene scene = renderScene(width, 120, 1);
  return {scene.left, scene.right};
}

TEST(FollowedRange, MeasuresTheFirstPairAndThenSome) {
  FollowedRange followed;
  const GrayPair flat{cv::Mat::zeros(120, 200, CV_8UC1), cv::Mat::zeros(120, 200, CV_8UC1)};
  EXPECT_EQ(followed.rangeOf(flat, 0).count, RangeFinder::kDefaultCount);
  const GrayPair pair = pairOfWidth(200);
  const DisparityRange own = OwnRange().rangeOf(pair, 0);
  ASSERT_NE(own.count, RangeFinder::kDefaultCount);
  for (int i = 1; i < FollowedRange::kPeriod; ++i) {
    EXPECT_EQ(followed.rangeOf(pair, 0).count, RangeFinder::kDefaultCount);
  }
  EXPECT_EQ(followed.rangeOf(pair, 0), own);
  for (int i = 0; i < 2 * FollowedRange::kPeriod; ++i) {
    EXPECT_EQ(followed.rangeOf(flat, 0), own) << "what tells nothing changes nothing";
  }
}

TEST(FollowedRange, BeginsAnewWithAnotherSizeOrLowestDisparity) {
  FollowedRange followed;
  const GrayPair flat{cv::Mat::zeros(120, 40, CV_8UC1), cv::Mat::zeros(120, 40, CV_8UC1)};
  const GrayPair pair = pairOfWidth(200);
  const DisparityRange own = followed.rangeOf(pair, 0);
  EXPECT_EQ(followed.rangeOf(flat, 0).count, 40);
  EXPECT_EQ(followed.rangeOf(pair, 0), own);
  EXPECT_EQ(followed.rangeOf(pair, -16), OwnRange().rangeOf(pair, -16));
}

}  // namespace
}  // namespace cbmv
