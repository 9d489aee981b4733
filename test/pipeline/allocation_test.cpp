// Counts allocations of a matcher on a stream of frames. The malloc functions below replace those
// of the C library in the whole program, including operator new, OpenCV and Eigen.

#include <array>
#include <atomic>
#include <cerrno>
#include <cstddef>
#include <cstdlib>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <malloc.h>
#include <tbb/task_arena.h>

#include "forest/forest_file.h"
#include "pipeline/disparity_estimator.h"
#include "refinement/bilateral_filter.h"
#include "support/random_forest.h"
#include "support/random_images.h"
#include "support/second_forest.h"

#include "cbmv_stereo/parameters.h"
#include "cbmv_stereo/stereo_matcher.h"

namespace {

/// Smaller blocks are not counted: oneTBB and OpenCV allocate a few of them, up to some hundred
/// bytes, and cv::Mat::setTo 1064 bytes. An image row, the smallest buffer of the method, is
/// larger.
constexpr std::size_t kLargeBytes = 1088;

std::atomic<int> blocks{0};
std::atomic<int> large_blocks{0};
std::atomic<long> bytes_in_use{0};

void* counted(void* block) {
  const std::size_t bytes = malloc_usable_size(block);
  bytes_in_use += static_cast<long>(bytes);
  ++blocks;
  if (bytes >= kLargeBytes) {
    ++large_blocks;
  }
  return block;
}

}  // namespace

extern "C" {

// The original functions of the C library:
void* __libc_malloc(std::size_t bytes);
void* __libc_calloc(std::size_t count, std::size_t bytes);
void* __libc_realloc(void* block, std::size_t bytes);
void* __libc_memalign(std::size_t alignment, std::size_t bytes);
void __libc_free(void* block);
// NOLINTEND(bugprone-reserved-identifier,readability-identifier-naming)

void* malloc(std::size_t bytes) { return counted(__libc_malloc(bytes)); }
void* calloc(std::size_t count, std::size_t bytes) { return counted(__libc_calloc(count, bytes)); }
void* realloc(void* block, std::size_t bytes) {
  bytes_in_use -= static_cast<long>(malloc_usable_size(block));
  return counted(__libc_realloc(block, bytes));
}
void* memalign(std::size_t alignment, std::size_t bytes) {
  return counted(__libc_memalign(alignment, bytes));
}
void free(void* block) {
  bytes_in_use -= static_cast<long>(malloc_usable_size(block));
  __libc_free(block);
}
void* aligned_alloc(std::size_t alignment, std::size_t bytes) { return memalign(alignment, bytes); }
int posix_memalign(void** block, std::size_t alignment, std::size_t bytes) {
  *block = memalign(alignment, bytes);
  return *block == nullptr ? ENOMEM : 0;
}

}  // extern "C"

namespace cbmv::test {
namespace {

struct Pair {
  cv::Mat left;
  cv::Mat right;
};

/// Every row is a large block, even of bytes.
const cv::Size kSize(1100, 21);

/// Pairs with different content.
std::array<Pair, 3> makePairs(const cv::Size& size) {
  return {{{makeGray(size, Content::kPatches, 1), makeGray(size, Content::kPatches, 2)},
           {makeGray(size, Content::kNoise, 3), makeGray(size, Content::kPatches, 4)},
           {makeGray(size, Content::kPatches, 5), makeGray(size, Content::kNoise, 6)}}};
}

VerticalOffset someOffset() {
  VerticalOffset offset;
  offset.offset_px = 0.4;
  offset.slope_x = 0.002;
  return offset;
}

/// A preset and a forest with a random second forest. General trees represent a random forest,
/// which has no second forest.
struct Setup {
  std::string preset;
  Forest forest;
};

std::vector<Setup> allSetups() {
  const auto shipped = [](const std::string& name) {
    Forest forest = readForest(CBMV_SOURCE_DIR "/models/" + name + ".forest");
    addSecondForest(1, forest);
    return forest;
  };
  return {{"quality", shipped("middlebury")},
          {"balanced", shipped("middlebury_small")},
          {"realtime", shipped("middlebury_small")},
          {"kitti", makeGeneralForest(3, 20, 1)}};
}

std::unique_ptr<StereoMatcher> makeMatcher(const Setup& setup, int search_levels = 0,
                                           const DisparityRange& range = {-3, 40}) {
  StereoOptions options;
  readPreset(CBMV_SOURCE_DIR "/config/" + setup.preset + ".yaml", options);
  options.search.levels = search_levels;
  options.refinement.speckle_size_px = 20;  // not set in any preset
  options.range = range;
  return std::make_unique<StereoMatcher>(std::make_shared<Forest>(setup.forest), options);
}

/// Number of large blocks allocated by `run`.
template <typename Run>
int blocksOf(const Run& run) {
  const int before = large_blocks;
  run();
  return large_blocks - before;
}

class Allocations : public testing::TestWithParam<Setup> {
 protected:
  std::unique_ptr<StereoMatcher> matcher_ = makeMatcher(GetParam());
  StereoResult result_;

  int blocksOfFrame(const Pair& pair) {
    return blocksOf([&] { matcher_->match(pair.left, pair.right, someOffset(), result_); });
  }
};

TEST_P(Allocations, AreNoneFromTheSecondFrameOn) {
  const auto pairs = makePairs(kSize);
  EXPECT_GT(blocksOfFrame(pairs[0]), 20);
  const long in_use = bytes_in_use;
  for (int frame = 1; frame < 7; ++frame) {
    EXPECT_EQ(blocksOfFrame(pairs[frame % 3]), 0) << "frame " << frame;
  }
  EXPECT_LT(bytes_in_use, in_use + 1024) << "nothing piles up";
}

/// Counts small blocks, too: a call on one thread allocates nothing in oneTBB.
TEST(BilateralFilterAllocations, AreNoneFromTheSecondCallOn) {
  const cv::Mat disparity(kSize, CV_32FC1, cv::Scalar(7));
  cv::Mat padded;
  cv::Mat filtered;
  const auto filter = [&] { bilateralFilter(disparity, {0, 40}, 2.2F, 1.3F, padded, filtered); };
  tbb::task_arena(1).execute([&] {
    filter();
    filter();
    const int before = blocks;
    filter();
    EXPECT_EQ(blocks - before, 0);
  });
}

/// Large enough that surfaces are first found at half size.
TEST(SurfaceAllocations, AreNoneFromTheSecondFrameOn) {
  const auto pairs = makePairs({1100, 128});
  const auto matcher = makeMatcher(allSetups().front());
  ASSERT_TRUE(findsSurfaces(pairs[0].left.size(), matcher->options()));
  StereoResult result;
  matcher->match(pairs[0].left, pairs[0].right, someOffset(), result);
  const long in_use = bytes_in_use;
  for (int frame = 1; frame < 4; ++frame) {
    const Pair& pair = pairs[frame % 3];
    EXPECT_EQ(blocksOf([&] { matcher->match(pair.left, pair.right, someOffset(), result); }), 0)
        << "frame " << frame;
  }
  EXPECT_LT(bytes_in_use, in_use + 1024) << "nothing piles up";
}

/// The lists of the search differ between pairs. Known pairs and similar pairs must not allocate.
TEST_P(Allocations, OfASearchAreNoneForPairsLikeThoseBefore) {
  const auto pairs = makePairs({1100, 140});
  matcher_ = makeMatcher(GetParam(), 3);
  for (const Pair& pair : pairs) {
    blocksOfFrame(pair);
  }
  const long in_use = bytes_in_use;
  for (int frame = 0; frame < 6; ++frame) {
    EXPECT_EQ(blocksOfFrame(pairs[frame % 3]), 0) << "frame " << frame;
  }
  EXPECT_LT(bytes_in_use, in_use + 16384) << "nothing piles up but tasks of oneTBB";
  Pair alike{pairs[0].left.clone(), pairs[0].right.clone()};
  alike.left(cv::Rect(500, 40, 40, 40)).setTo(100);
  alike.right(cv::Rect(485, 40, 40, 40)).setTo(100);
  EXPECT_LT(blocksOfFrame(alike), 5);
}

/// With a live camera, the range changes rarely.
TEST_P(Allocations, AreNoneWhileAnAutomaticRangeStays) {
  const auto pairs = makePairs({1100, 140});
  matcher_ = makeMatcher(GetParam(), 3, {0, 0});
  blocksOfFrame(pairs[0]);
  EXPECT_EQ(blocksOfFrame(pairs[0]), 0);
}

TEST_P(Allocations, OfFreshResultsAreTheirMaps) {
  const auto pairs = makePairs(kSize);
  for (int frame = 0; frame < 4; ++frame) {
    const Pair& pair = pairs[frame % 3];
    StereoResult fresh;
    const int blocks =
        blocksOf([&] { fresh = matcher_->match(pair.left, pair.right, someOffset()); });
    if (frame > 0) {
      const bool has_sigma = GetParam().forest.confidence != nullptr;
      EXPECT_EQ(blocks, has_sigma ? 6 : 5)
          << "disparity, right disparity, labels, confidence, margin, standard deviation";
    }
  }
}

/// Matches smaller images between two frames. The results equal those of a new matcher, and later
/// frames do not allocate.
TEST_P(Allocations, StopAgainAfterAChangeOfSize) {
  const auto pairs = makePairs(kSize);
  const auto others = makePairs({97, 41});
  for (const auto* some : {&pairs, &others, &pairs}) {
    blocksOfFrame((*some)[0]);
    EXPECT_EQ(blocksOfFrame((*some)[1]), 0);
    StereoResult expected;
    makeMatcher(GetParam())->match((*some)[1].left, (*some)[1].right, someOffset(), expected);
    EXPECT_EQ(cv::norm(result_.disparity, expected.disparity, cv::NORM_INF), 0);
    EXPECT_EQ(cv::norm(result_.confidence, expected.confidence, cv::NORM_INF), 0);
  }
}

INSTANTIATE_TEST_SUITE_P(Presets, Allocations, testing::ValuesIn(allSetups()),
                         [](const auto& info) { return info.param.preset; });

}  // namespace
}  // namespace cbmv::test
