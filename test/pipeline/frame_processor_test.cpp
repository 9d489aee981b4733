#include "pipeline/frame_processor.h"

#include <chrono>
#include <cmath>
#include <thread>

#include <gtest/gtest.h>

#include "evaluation/rendered_scene.h"
#include "pipeline/memory.h"
#include "support/error_text.h"
#include "support/forest_fixture.h"

namespace cbmv {
namespace {

const InputNames kNames = {"left.png", "left.yaml", "right.png", "right.yaml"};

CameraCalibration camera(cv::Size size, double p3) {
  CameraCalibration calibration;
  calibration.width = size.width;
  calibration.height = size.height;
  calibration.rectification = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  const double cx = size.width / 2.0;
  const double cy = size.height / 2.0;
  calibration.camera_matrix = {200, 0, cx, 0, 200, cy, 0, 0, 1};
  calibration.projection = {200, 0, cx, p3, 0, 200, cy, 0, 0, 0, 1, 0};
  return calibration;
}

StereoInput pairWithOffset(int width = 251) {
  RenderOptions options;
  options.vertical_offset = 0.8;
  const RenderedScene scene = renderScene(width, 131, 1, options);
  StereoInput input;
  input.left = scene.left;
  input.right = scene.right;
  input.cameras = {camera(scene.left.size(), 0), camera(scene.left.size(), -20)};
  input.names = kNames;
  return input;
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
  ProcessedFrame process(const StereoInput& input = pairWithOffset()) {
    return processor_.match(processor_.prepare(input), offset_);
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
  FrameProcessor processor_{std::make_shared<const Forest>(makeForestFixture()), options_};
  FollowedOffset offset_;
};

TEST_F(Processor, TellsTheVerticalOffset) {
  EXPECT_EQ(process().rectification.measurement.model.matches, 0);
  const ProcessedFrame frame = processUntilMeasured();
  EXPECT_TRUE(frame.rectification.is_watched);
  EXPECT_NEAR(frame.rectification.measurement.model.offset_px, 0.8, 0.05);
  EXPECT_EQ(frame.result.rectification.offset_px, frame.rectification.measurement.model.offset_px);
  EXPECT_GT(frame.rectification.age_s, 0);
  EXPECT_LT(frame.rectification.age_s, 60);
  EXPECT_GT(frame.result.memory_mb, 0);  // lists of this pair
  EXPECT_LT(frame.result.memory_mb, requiredMemoryMb({251, 131}, options_));
}

TEST(DisparityStep, IsWholePixelsOnlyWithoutSubpixelStages) {
  RefinementOptions options;
  options.subpixel = false;
  options.bilateral_sigma_px = 0;
  EXPECT_EQ(disparityStep({0, 64}, options), 1);
  options.bilateral_sigma_px = 2;
  EXPECT_EQ(disparityStep({0, 64}, options), std::ldexp(1.0, -18));  // floats from 32 to 64
  options = RefinementOptions();
  EXPECT_EQ(disparityStep({-100, 64}, options), std::ldexp(1.0, -17));
}

TEST(OptionsFor, RejectWhatTheMachineHasNoMemoryFor) {
  StereoOptions options;
  options.range.count = 4096;
  EXPECT_NO_THROW(optionsFor({64, 48}, options, ""));
  try {
    optionsFor({2000000, 2000000}, options, "/left");
    FAIL() << "nothing was thrown";
  } catch (const InputError& error) {
    EXPECT_EQ(error.fault(), InputFault::kMemory);
    EXPECT_TRUE(mentions(error.what(),
                         {"/left: images of 2000000x2000000 pixels with 4096 disparities need ",
                          "the machine has "}));
  }
}

TEST_F(Processor, TakesTheGeometryFromTheCalibration) {
  const ProcessedFrame frame = process();
  EXPECT_DOUBLE_EQ(frame.geometry.baseline_m, 0.1);
  EXPECT_TRUE(frame.warnings.empty());
}

TEST_F(Processor, PassesWarningsOn) {
  StereoInput input = pairWithOffset();
  input.warnings = {"of the input"};
  input.cameras->right.projection[6] += 3;
  input.cameras->right.camera_matrix[5] += 3;
  const ProcessedFrame frame = process(input);
  ASSERT_EQ(frame.warnings.size(), 2U);
  EXPECT_EQ(frame.warnings[0], "of the input");
  EXPECT_TRUE(mentions(frame.warnings[1], {"left.yaml and right.yaml", "cy"}));
}

TEST_F(Processor, ChecksACalibrationThatChanges) {
  process();
  StereoInput input = pairWithOffset();
  input.cameras->right.projection[3] = 0;
  EXPECT_THROW(process(input), InputError);
  EXPECT_NO_THROW(process());
}

TEST_F(Processor, NeedsNoCalibration) {
  StereoInput input = pairWithOffset();
  OwnOffset own;
  const cv::Mat expected = processor_.match(processor_.prepare(input), own).result.disparity;
  input.cameras.reset();
  const ProcessedFrame frame = processor_.match(processor_.prepare(input), own);
  EXPECT_EQ(frame.geometry.baseline_m, 0);
  EXPECT_EQ(cv::norm(frame.result.disparity, expected, cv::NORM_INF), 0);
}

TEST_F(Processor, RejectsImagesThatAreNoPair) {
  StereoInput input = pairWithOffset();
  input.right = input.right.colRange(0, 250);
  EXPECT_TRUE(mentions(errorText([&] { processor_.prepare(input); }),
                       {"left.png and right.png", "251 x 131", "250 x 131"}));
  input.right = cv::Mat();
  EXPECT_TRUE(mentions(errorText([&] { processor_.prepare(input); }), {"right.png", "empty"}));
}

/// A single pair, a given offset and a stream with a known offset give bit-identical results.
TEST_F(Processor, SourcesOfTheOffsetAgree) {
  const PreparedPair pair = processor_.prepare(pairWithOffset());
  const VerticalOffset estimated = processor_.estimateOffset(pair);
  ASSERT_GT(estimated.matches, 0);
  GivenOffset given(estimated);
  OwnOffset own;
  EXPECT_EQ(cv::norm(processor_.match(pair, given).result.disparity,
                     processor_.match(pair, own).result.disparity, cv::NORM_INF),
            0);
  const StereoResult followed = processUntilMeasured().result;
  EXPECT_EQ(
      cv::norm(processor_.match(pair, given).result.disparity, followed.disparity, cv::NORM_INF),
      0);
}

TEST_F(Processor, FindsARangeThatIsAutomatic) {
  const StereoInput input = pairWithOffset();
  const PreparedPair pair = processor_.prepare(input);
  options_.range = {-16, 0};
  processor_.setOptions(options_);
  const DisparityRange own = processor_.rangeOf(pair);
  EXPECT_EQ(own, RangeFinder().find(input.left, input.right, -16));
  const ProcessedFrame frame = process(input);
  EXPECT_EQ(frame.result.range, own);
  EXPECT_TRUE(frame.range_is_automatic);
  EXPECT_TRUE(frame.range_correction.empty());

  StereoMatcher matcher(std::make_shared<const Forest>(makeForestFixture()), options_);
  EXPECT_EQ(matcher.match(input.left, input.right).range, own);

  options_.range = own;
  processor_.setOptions(options_);
  EXPECT_FALSE(process(input).range_is_automatic);
}

/// The range found in a pair does not depend on earlier pairs; a followed range does.
TEST_F(Processor, TakesTheRangeFromItsSource) {
  options_.range.count = 0;
  processor_.setOptions(options_);
  const PreparedPair pair = processor_.prepare(pairWithOffset());
  PreparedPair flat = pair;
  flat.images = {cv::Mat(131, 251, CV_8UC1, cv::Scalar(9)),
                 cv::Mat(131, 251, CV_8UC1, cv::Scalar(9))};
  FollowedRange followed;
  const DisparityRange found = processor_.match(pair, offset_, followed).result.range;
  EXPECT_EQ(processor_.match(flat, offset_).result.range.count, RangeFinder::kDefaultCount);
  EXPECT_EQ(processor_.match(flat, offset_, followed).result.range, found);
  EXPECT_EQ(processor_.match(pair, offset_).result.range, found);
}

/// The error that node and bag processing expect for unusable input.
TEST_F(Processor, NamesTheImageWhoseSearchNeedsTooMuchMemory) {
  options_.search.levels = 2;
  options_.range.count = 120;
  processor_.setOptions(options_);
  StereoInput input = pairWithOffset();
  cv::randu(input.left, 0, 256);
  const PreparedPair pair = processor_.prepare(input);
  const double needed = processor_.match(pair, offset_).result.memory_mb;
  const double expected = requiredMemoryMb({251, 131}, options_);
  ASSERT_GT(std::floor(needed), expected) << "many disparities compete where nothing matches";
  options_.max_memory_mb = static_cast<int>(std::ceil(expected));
  processor_.setOptions(options_);
  try {
    processor_.match(pair, offset_);
    FAIL() << "nothing was thrown";
  } catch (const InputError& error) {
    EXPECT_EQ(error.fault(), InputFault::kMemory);
    EXPECT_TRUE(mentions(error.what(), {"left.png: images of 251x131", "max_memory_mb allows"}));
  }
  EXPECT_NO_THROW(process()) << "the next pair needs less";
}

TEST_F(Processor, LooksAtTheMemoryAnewWhenTheSizeChanges) {
  options_.max_memory_mb = static_cast<int>(std::ceil(requiredMemoryMb({251, 131}, options_)));
  processor_.setOptions(options_);
  EXPECT_NO_THROW(process());
  EXPECT_THROW(process(pairWithOffset(600)), InputError);
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
  EXPECT_EQ(process(pairWithOffset(231)).result.rectification.matches, 0);
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
