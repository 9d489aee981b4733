#include "pipeline/memory.h"

#include <cmath>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <malloc.h>

#include "evaluation/rendered_scene.h"
#include "forest/forest_file.h"
#include "support/error_text.h"
#include "support/random_forest.h"
#include "support/random_images.h"
#include "support/second_forest.h"

#include "cbmv_stereo/parameters.h"
#include "cbmv_stereo/stereo_matcher.h"

namespace cbmv::test {
namespace {

/// A memory value of this process in MB, by its name in /proc/self/status.
double memoryMb(const std::string& name) {
  std::ifstream status("/proc/self/status");
  std::string word;
  while (status >> word && word != name + ":") {
  }
  double kilobytes = 0;
  status >> kilobytes;
  return kilobytes / 1024;
}

/// Restarts the measurement of peak memory.
bool resetPeak() {
  std::ofstream references("/proc/self/clear_refs");
  references << 5 << std::flush;
  return static_cast<bool>(references);
}

struct Example {
  std::string preset;
  std::string forest;
  cv::Size size;
  int disparities;
  int search_levels = 0;
};

StereoOptions optionsOf(const Example& example) {
  StereoOptions options;
  readPreset(CBMV_SOURCE_DIR "/config/" + example.preset + ".yaml", options);
  options.range = {0, example.disparities};
  options.search.levels = example.search_levels;
  return options;
}

struct Pair {
  cv::Mat left;
  cv::Mat right;
};

/// Measured and estimated peak memory of a new matcher, MB.
struct Memory {
  double measured = 0;
  double told = 0;
};

Memory measureMemory(const Example& example, const Pair& pair) {
  mallopt(M_MMAP_THRESHOLD, 1 << 16);  // returns freed memory to the system immediately
  const StereoOptions options = optionsOf(example);
  const auto forest =
      std::make_shared<Forest>(readForest(CBMV_SOURCE_DIR "/models/" + example.forest + ".forest"));
  addSecondForest(1, *forest);
  // Loads the pages of the program and starts the threads.
  const cv::Rect small(0, 0, 60, 40);
  StereoMatcher(forest, options).match(pair.left(small), pair.right(small));
  malloc_trim(0);
  if (!resetPeak()) {
    return {};
  }
  const double before = memoryMb("VmRSS");
  StereoMatcher matcher(forest, options);
  Memory memory;
  for (int frame = 0; frame < 2; ++frame) {
    memory.told = matcher.match(pair.left, pair.right).memory_mb;
  }
  memory.measured = memoryMb("VmHWM") - before;
  return memory;
}

class RequiredMemory : public testing::TestWithParam<Example> {};

/// An estimate that is too low breaks the limit; one that is too high rejects possible images.
TEST_P(RequiredMemory, IsTheMeasuredPeak) {
  const Example& example = GetParam();
  const Memory memory = measureMemory(example, {makeGray(example.size, Content::kPatches, 1),
                                                makeGray(example.size, Content::kPatches, 2)});
  if (memory.measured == 0) {
    GTEST_SKIP() << "this system does not let a process reset its peak memory";
  }
  RecordProperty("measured_mb", std::to_string(memory.measured));
  RecordProperty("required_mb", std::to_string(memory.told));
  EXPECT_EQ(memory.told, requiredMemoryMb(example.size, optionsOf(example)));
  EXPECT_LT(memory.told, 1.15 * memory.measured);
  EXPECT_GT(memory.told, memory.measured / 1.05);
}

INSTANTIATE_TEST_SUITE_P(Examples, RequiredMemory,
                         testing::Values(Example{"quality", "middlebury", {640, 160}, 64},
                                         Example{"quality", "middlebury", {400, 160}, 150},
                                         Example{"quality", "middlebury", {500, 270}, 64},
                                         Example{"realtime", "middlebury_small", {640, 160}, 64},
                                         Example{"realtime", "middlebury_small", {400, 160}, 150},
                                         Example{"balanced", "middlebury_small", {1242, 40}, 228}),
                         [](const auto& info) {
                           return info.param.preset + std::to_string(info.param.size.width) + "x" +
                                  std::to_string(info.param.size.height) + "x" +
                                  std::to_string(info.param.disparities);
                         });

class SearchMemory : public testing::TestWithParam<Example> {};

/// Estimate for the lists of this pair; the estimate for all pairs is higher.
TEST_P(SearchMemory, IsTheMeasuredPeak) {
  const Example& example = GetParam();
  const RenderedScene scene = renderScene(example.size.width, example.size.height, 3);
  const Memory memory = measureMemory(example, {scene.left, scene.right});
  if (memory.measured == 0) {
    GTEST_SKIP() << "this system does not let a process reset its peak memory";
  }
  RecordProperty("measured_mb", std::to_string(memory.measured));
  RecordProperty("required_mb", std::to_string(memory.told));
  EXPECT_LT(memory.told, 1.25 * memory.measured);
  EXPECT_GT(memory.told, memory.measured / 1.05);
  EXPECT_GT(requiredMemoryMb(example.size, optionsOf(example)), memory.told);
  Example exhaustive = example;
  exhaustive.search_levels = 0;
  EXPECT_LT(memory.told, 0.7 * requiredMemoryMb(example.size, optionsOf(exhaustive)));
}

INSTANTIATE_TEST_SUITE_P(
    Examples, SearchMemory,
    testing::Values(Example{"quality", "middlebury", {640, 320}, 64, 3},
                    Example{"quality", "middlebury", {900, 300}, 228, 3},
                    Example{"realtime", "middlebury_small", {640, 320}, 64, 3},
                    Example{"realtime", "middlebury_small", {900, 300}, 228, 3},
                    Example{"balanced", "middlebury_small", {640, 320}, 100, 2}),
    [](const auto& info) {
      return info.param.preset + std::to_string(info.param.size.width) + "x" +
             std::to_string(info.param.disparities);
    });

TEST(SearchMemoryMb, CountsEveryLevelsHypotheses) {
  StereoOptions options;
  options.range = {0, 100};
  options.search.levels = 2;
  options.refinement.optimize_right_view = false;
  std::vector<double> hypotheses = expectedHypotheses({1000, 800}, options);
  ASSERT_EQ(hypotheses.size(), 3U);
  EXPECT_EQ(hypotheses[0], 800e3 * kListedDisparities);
  EXPECT_EQ(hypotheses[2], 50e3 * 25);
  const double before = searchMemoryMb({1000, 800}, options, hypotheses);
  EXPECT_EQ(before, requiredMemoryMb({1000, 800}, options));
  hypotheses[1] += 1e6;
  const double more = searchMemoryMb({1000, 800}, options, hypotheses) - before;
  EXPECT_GT(more, 5e6 / (1 << 20));
  EXPECT_LT(more, 7e6 / (1 << 20));
}

TEST(SearchMemoryMb, GrowsLittleWithTheRange) {
  StereoOptions options;
  options.search.levels = 3;
  options.range = {0, 64};
  const double narrow = requiredMemoryMb({1242, 375}, options);
  options.range = {0, 256};
  EXPECT_LT(requiredMemoryMb({1242, 375}, options), 1.25 * narrow);
}

/// At full size only.
TEST(RequiredMemoryMb, OfTheSecondForestIsOfPixels) {
  StereoOptions options;
  options.threads = 1;
  for (const int levels : {0, 3}) {
    options.search.levels = levels;
    options.range = {0, 128};
    options.refinement.second_forest = true;
    options.refinement.replace_improbable = true;
    const double with = requiredMemoryMb({1000, 1000}, options);
    options.refinement.replace_improbable = false;
    EXPECT_NEAR((with - requiredMemoryMb({1000, 1000}, options)) * (1 << 20), 17e6, 0.1e6);
    options.refinement.second_forest = false;
    const double bytes = (with - requiredMemoryMb({1000, 1000}, options)) * (1 << 20);
    EXPECT_NEAR(bytes, 35.25e6, 0.1e6);
  }
}

TEST(RequiredMemoryMb, OfOneVolumeMoreWithMoreThanOneStep) {
  StereoOptions options;
  options.search.levels = 0;
  options.range = {0, 100};
  options.aggregation.iterations_after = 0;
  options.surface.enabled = false;
  options.sgm.iterations = 1;
  const double one = requiredMemoryMb({1000, 1000}, options);
  options.sgm.iterations = 2;
  EXPECT_NEAR(requiredMemoryMb({1000, 1000}, options) - one, 200e6 / (1 << 20), 1e-6);
}

TEST(MemoryError, NamesBothNumbersAndWhatHelps) {
  StereoOptions options;
  options.range = {0, 128};
  const int needed = static_cast<int>(std::ceil(requiredMemoryMb({640, 480}, options)));
  EXPECT_EQ(memoryError({640, 480}, options), "") << "no bound";
  options.max_memory_mb = needed;
  EXPECT_EQ(memoryError({640, 480}, options), "");
  options.max_memory_mb = needed - 1;
  EXPECT_TRUE(mentions(memoryError({640, 480}, options),
                       {"640x480", "128 disparities", std::to_string(needed) + " MB",
                        std::to_string(needed - 1), "disparity_range"}));
}

TEST(MemoryError, IsWhatTheMatcherThrows) {
  StereoOptions options;
  options.max_memory_mb = 1;
  const cv::Mat gray = makeGray({200, 100}, Content::kPatches, 1);
  StereoMatcher matcher(std::make_shared<Forest>(makeForest(8, 5, 3)), options);
  EXPECT_EQ(errorText([&] { matcher.match(gray, gray); }), memoryError(gray.size(), options));
  options.max_memory_mb = 100;
  matcher.setOptions(options);
  EXPECT_EQ(matcher.match(gray, gray).disparity.size(), gray.size());
}

}  // namespace
}  // namespace cbmv::test
