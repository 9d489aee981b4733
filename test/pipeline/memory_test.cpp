#include "cbmv_stereo/pipeline/memory.h"

#include <cmath>
#include <fstream>
#include <memory>
#include <string>

#include <gtest/gtest.h>
#include <malloc.h>

#include "support/error_text.h"
#include "support/random_forest.h"
#include "support/random_images.h"

#include "cbmv_stereo/forest/forest_file.h"
#include "cbmv_stereo/pipeline/parameters.h"
#include "cbmv_stereo/pipeline/stereo_matcher.h"

namespace cbmv::test {
namespace {

/// Memory of this process in MB, by its name in /proc/self/status.
double memoryMb(const std::string& name) {
  std::ifstream status("/proc/self/status");
  std::string word;
  while (status >> word && word != name + ":") {
  }
  double kilobytes = 0;
  status >> kilobytes;
  return kilobytes / 1024;
}

/// From now on, the peak is of now.
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
};

StereoOptions optionsOf(const Example& example) {
  StereoOptions options;
  readPreset(CBMV_SOURCE_DIR "/config/" + example.preset + ".yaml", options);
  options.range = {0, example.disparities};
  return options;
}

class RequiredMemory : public testing::TestWithParam<Example> {};

/// More than estimated would break the bound, much less would refuse what is possible.
TEST_P(RequiredMemory, IsTheMeasuredPeak) {
  const Example& example = GetParam();
  mallopt(M_MMAP_THRESHOLD, 1 << 16);  // what is freed goes back to the system at once
  const StereoOptions options = optionsOf(example);
  const auto forest =
      std::make_shared<Forest>(readForest(CBMV_SOURCE_DIR "/models/" + example.forest + ".forest"));
  const cv::Mat left = makeGrey(example.size, Content::kPatches, 1);
  const cv::Mat right = makeGrey(example.size, Content::kPatches, 2);
  // Loads the program's pages and starts the threads.
  StereoMatcher(forest, options).match(left(cv::Rect(0, 0, 60, 40)), right(cv::Rect(0, 0, 60, 40)));
  malloc_trim(0);
  if (!resetPeak()) {
    GTEST_SKIP() << "this system does not let a process reset its peak memory";
  }
  const double before = memoryMb("VmRSS");
  StereoMatcher matcher(forest, options);
  for (int frame = 0; frame < 2; ++frame) {
    matcher.match(left, right);
  }
  const double measured = memoryMb("VmHWM") - before;
  const double required = requiredMemoryMb(example.size, options);
  RecordProperty("measured_mb", std::to_string(measured));
  RecordProperty("required_mb", std::to_string(required));
  EXPECT_LT(required, 1.15 * measured);
  EXPECT_GT(required, measured / 1.05);
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

TEST(RequiredMemoryMb, OfOneVolumeMoreWithMoreThanOneStep) {
  StereoOptions options;
  options.range = {0, 100};
  options.aggregation.iterations_after = 0;
  options.surface.enabled = false;
  options.sgm.iterations = 1;
  const double one = requiredMemoryMb({1000, 1000}, options);
  options.sgm.iterations = 2;
  EXPECT_NEAR(requiredMemoryMb({1000, 1000}, options) - one, 200e6 / (1 << 20), 1e-6);
}

TEST(MemoryRefusal, NamesBothNumbersAndWhatHelps) {
  StereoOptions options;
  options.range = {0, 128};
  const int needed = static_cast<int>(std::ceil(requiredMemoryMb({640, 480}, options)));
  EXPECT_EQ(memoryRefusal({640, 480}, options), "") << "no bound";
  options.max_memory_mb = needed;
  EXPECT_EQ(memoryRefusal({640, 480}, options), "");
  options.max_memory_mb = needed - 1;
  EXPECT_TRUE(mentions(memoryRefusal({640, 480}, options),
                       {"640x480", "128 disparities", std::to_string(needed) + " MB",
                        std::to_string(needed - 1), "disparity_range"}));
}

TEST(MemoryRefusal, IsWhatTheMatcherThrows) {
  StereoOptions options;
  options.max_memory_mb = 1;
  const cv::Mat grey = makeGrey({200, 100}, Content::kPatches, 1);
  StereoMatcher matcher(std::make_shared<Forest>(makeForest(8, 5, 3)), options);
  EXPECT_EQ(errorText([&] { matcher.match(grey, grey); }), memoryRefusal(grey.size(), options));
  options.max_memory_mb = 100;
  matcher.setOptions(options);
  EXPECT_EQ(matcher.match(grey, grey).disparity.size(), grey.size());
}

}  // namespace
}  // namespace cbmv::test
