#include "search/range_finder.h"

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>
#include <tbb/global_control.h>

#include "evaluation/rendered_scene.h"

namespace cbmv {
namespace {

struct Pair {
  cv::Mat left, right;
};

cv::Mat makeTexture(const cv::Size& size, int seed) {
  cv::Mat texture(size, CV_8UC1);
  cv::RNG random(static_cast<std::uint64_t>(seed));
  random.fill(texture, cv::RNG::UNIFORM, 0, 256);
  cv::GaussianBlur(texture, texture, {5, 5}, 1.2);
  return texture;
}

/// A plane at this disparity, which may be negative.
Pair makePlane(const cv::Size& size, int disparity) {
  const int reach = std::abs(disparity);
  const cv::Mat texture = makeTexture({size.width + 2 * reach, size.height}, 1);
  return {texture(cv::Rect({reach, 0}, size)).clone(),
          texture(cv::Rect({reach + disparity, 0}, size)).clone()};
}

/// Adds a textured object in front of the scene; `place` is its position in the left image.
void addObject(const cv::Rect& place, int disparity, const Pair& pair) {
  const cv::Mat texture = makeTexture(place.size(), 2);
  texture.copyTo(pair.left(place));
  texture.copyTo(pair.right(place - cv::Point(disparity, 0)));
}

int countOf(const Pair& pair, int min_disparity = 0) {
  const auto found = RangeFinder().find(pair.left, pair.right, min_disparity);
  return found ? found->count : -1;
}

TEST(RangeFinder, CoversWhatIsThereAndLittleMore) {
  for (const cv::Size& size : {cv::Size(320, 240), cv::Size(640, 480), cv::Size(1242, 375)}) {
    const RenderedScene scene = renderScene(size.width, size.height, 3);
    double nearest = 0;
    cv::minMaxLoc(scene.truth, nullptr, &nearest);
    const auto found = RangeFinder().find(scene.left, scene.right, 0);
    ASSERT_TRUE(found) << size;
    EXPECT_EQ(found->min, 0);
    EXPECT_EQ(found->count % RangeFinder::kStep, 0);
    EXPECT_GT(found->max(), nearest) << size;
    EXPECT_LE(found->count, 1.5 * (nearest + RangeFinder::kStep)) << size;
  }
}

/// A person, and a pole that is 8 px wide.
TEST(RangeFinder, SeesSmallObjectsThatAreNear) {
  for (const cv::Size& object : {cv::Size(40, 100), cv::Size(8, 300)}) {
    const Pair pair = makePlane({640, 480}, 6);
    addObject({{420, 120}, object}, 150, pair);
    EXPECT_GT(countOf(pair), 150) << object;
    EXPECT_LE(countOf(pair), 208) << object;
  }
}

TEST(RangeFinder, LeavesOutOutliers) {
  const Pair pair = makePlane({320, 240}, 6);
  const int without = countOf(pair);
  for (int i = 0; i < 12; ++i) {
    addObject({130 + 50 * (i % 4), 20 + 60 * (i / 4), 6, 4}, 70 + 3 * i, pair);
  }
  EXPECT_EQ(countOf(pair), without);
}

TEST(RangeFinder, FindsNothingWithoutTexture) {
  const cv::Mat flat(240, 320, CV_8UC1, cv::Scalar(100));
  EXPECT_EQ(RangeFinder().find(flat, flat, 0), std::nullopt);
}

TEST(RangeFinder, TakesTinyImages) {
  for (const cv::Size& size : {cv::Size(1, 1), cv::Size(2, 1), cv::Size(1, 50), cv::Size(5, 3)}) {
    const cv::Mat image = makeTexture(size, 4);
    EXPECT_EQ(RangeFinder().find(image, image, 0), std::nullopt) << size;
  }
  const cv::Mat line = makeTexture({5000, 1}, 4);
  EXPECT_NO_THROW(RangeFinder().find(line, line, 0));
}

TEST(RangeFinder, EndsWithTheImage) {
  const Pair pair = makePlane({100, 60}, 45);
  EXPECT_EQ(countOf(pair), 64);
  EXPECT_EQ(countOf(pair, 40), 16);
  const Pair narrow = makePlane({60, 60}, 26);
  EXPECT_EQ(countOf(narrow), 48);
  EXPECT_EQ(countOf(makePlane({38, 60}, 17)), 32);
  EXPECT_EQ(countOf(makePlane({38, 60}, 17), 12), 16);
  EXPECT_EQ(RangeFinder::defaultRange(0, 50).count, 50);
  EXPECT_EQ(RangeFinder::defaultRange(-10, 640), (DisparityRange{-10, 64}));
  EXPECT_EQ(RangeFinder::defaultRange(700, 640).count, 1);
}

TEST(RangeFinder, BeginsAtTheLowestDisparity) {
  EXPECT_EQ(countOf(makePlane({640, 480}, 30), -20), 80);
  const auto found =
      RangeFinder().find(makePlane({640, 480}, -10).left, makePlane({640, 480}, -10).right, -33);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->min, -33);
  EXPECT_GE(found->max(), -10);
  EXPECT_LE(found->count, 48);
}

TEST(RangeFinder, DependsNeitherOnThreadsNorOnEarlierPairs) {
  const RenderedScene scene = renderScene(640, 300, 5);
  RangeFinder finder;
  const auto expected = finder.find(scene.left, scene.right, 0);
  const Pair other = makePlane({320, 240}, 100);
  finder.find(other.left, other.right, -4);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(finder.find(scene.left, scene.right, 0), expected);
}

}  // namespace
}  // namespace cbmv
