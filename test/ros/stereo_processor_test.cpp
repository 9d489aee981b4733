#include "ros/stereo_processor.h"

#include <chrono>
#include <cmath>
#include <thread>

#include <gtest/gtest.h>

#include "ros/forest_fixture.h"
#include "ros/stereo_pair.h"
#include "support/error_text.h"

#include "cbmv_stereo/evaluation/rendered_scene.h"
#include "cbmv_stereo/pipeline/memory.h"

namespace cbmv {
namespace {

const StereoTopics kTopics = {"left/image_rect", "left/camera_info", "right/image_rect",
                              "right/camera_info"};

StereoMessages misalignedPair(int width = 251) {
  RenderOptions options;
  options.vertical_offset = 0.8;
  const RenderedScene scene = renderScene(width, 131, 1, options);
  return makeMessages({scene.left, scene.right, {}}, {}, ros::Time(1)).asConst();
}

StereoOptions fastOptions() {
  StereoOptions options;
  options.range = {0, 32};
  options.surface.enabled = false;
  options.aggregation.iterations_after = 0;
  options.sgm.iterations = 0;
  options.rectification.interval_s = 1000;  // one measurement
  return options;
}

class Processor : public testing::Test {
 protected:
  ProcessedFrame process(const StereoMessages& messages = misalignedPair()) {
    return processor_.process(messages, kTopics);
  }

  /// Processes pairs until the vertical offset is known.
  ProcessedFrame processUntilMeasured() {
    for (int i = 0; i < 200; ++i) {
      ProcessedFrame frame = process();
      if (frame.rectification.measurement.model.matches > 0) {
        return process();
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    ADD_FAILURE() << "nothing was measured";
    return {};
  }

  StereoOptions options_ = fastOptions();
  StereoProcessor processor_{std::make_shared<const Forest>(makeForestFixture()), options_, false};
};

TEST_F(Processor, TellsTheVerticalOffset) {
  EXPECT_EQ(process().rectification.measurement.model.matches, 0);
  const ProcessedFrame frame = processUntilMeasured();
  EXPECT_TRUE(frame.rectification.is_watched);
  EXPECT_NEAR(frame.rectification.measurement.model.offset_px, 0.8, 0.05);
  EXPECT_EQ(frame.result.rectification.offset_px, frame.rectification.measurement.model.offset_px);
  EXPECT_GT(frame.rectification.age_s, 0);
  EXPECT_LT(frame.rectification.age_s, 60);
  EXPECT_GT(frame.memory_mb, 0);
}

TEST(OptionsFor, RefuseWhatTheMachineHasNoMemoryFor) {
  StereoOptions options;
  options.range.count = 4096;
  EXPECT_NO_THROW(optionsFor({64, 48}, options));
  try {
    optionsFor({2000000, 2000000}, options, "/left: ");
    FAIL() << "nothing was thrown";
  } catch (const InputError& error) {
    EXPECT_EQ(error.fault(), InputFault::kMemory);
    EXPECT_TRUE(mentions(error.what(), {"/left: 2000000 x 2000000 px need ", "the machine has "}));
  }
}

TEST_F(Processor, LooksAtTheMemoryAnewWhenTheSizeChanges) {
  options_.max_memory_mb = static_cast<int>(std::ceil(requiredMemoryMb({251, 131}, options_)));
  processor_.setOptions(options_);
  EXPECT_NO_THROW(process());
  EXPECT_THROW(process(misalignedPair(600)), InputError);
  EXPECT_NO_THROW(process());
}

TEST_F(Processor, KeepsTheVerticalOffsetWhenOtherParametersChange) {
  const VerticalOffset before = processUntilMeasured().result.rectification;
  options_.sgm.p1 = 0.5;
  options_.refinement.median_size_px = 5;
  options_.range.count = 24;
  options_.max_memory_mb = 1000;
  processor_.setOptions(options_);
  const ProcessedFrame after = process();
  EXPECT_EQ(after.result.range.count, 24);
  EXPECT_EQ(after.result.rectification.offset_px, before.offset_px);
  EXPECT_EQ(after.result.rectification.slope_x, before.slope_x);
}

TEST_F(Processor, ForgetsTheVerticalOffsetWhenItsParametersOrTheSizeChange) {
  processUntilMeasured();
  EXPECT_EQ(process(misalignedPair(231)).result.rectification.matches, 0);
  processUntilMeasured();
  options_.rectification.max_offset_px = 3;
  processor_.setOptions(options_);
  EXPECT_EQ(process().result.rectification.matches, 0);
  processUntilMeasured();
  options_.rectification.enabled = false;
  processor_.setOptions(options_);
  const ProcessedFrame off = process();
  EXPECT_FALSE(off.rectification.is_watched);
  EXPECT_EQ(off.rectification.measurement.model.matches, 0);
}

}  // namespace
}  // namespace cbmv
