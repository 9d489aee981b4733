#include "ros/stereo_diagnostics.h"

#include <map>

#include <gtest/gtest.h>

namespace cbmv {
namespace {

using diagnostic_msgs::DiagnosticStatus;
using Describe = void (StereoDiagnostics::*)(StereoDiagnostics::Status&, ros::SteadyTime) const;

ros::SteadyTime at(double time_s) { return ros::SteadyTime(1000 + time_s); }

struct Report {
  int level;
  std::string message;
  std::map<std::string, std::string> values;
};

Report report(const StereoDiagnostics& diagnostics, Describe describe, double time_s) {
  StereoDiagnostics::Status status;
  (diagnostics.*describe)(status, at(time_s));
  Report found{status.level, status.message, {}};
  for (const auto& entry : status.values) {
    found.values[entry.key] = entry.value;
  }
  return found;
}

void expectHolds(const std::string& text, const std::string& words) {
  EXPECT_NE(text.find(words), std::string::npos) << "'" << text << "' lacks '" << words << "'";
}

ProcessedFrame makeFrame(double offset_px = 0) {
  ProcessedFrame frame;
  frame.left_gray = cv::Mat(48, 64, CV_8UC1);
  frame.geometry.focal_length_px = 700;
  frame.geometry.baseline_m = 0.12;
  frame.result.times = {1, 20, 30, 40, 5, 6, 102};
  frame.result.memory_mb = 123;
  frame.rectification.is_watched = true;
  frame.rectification.age_s = 0.5;
  VerticalOffsetMeasurement& measurement = frame.rectification.measurement;
  measurement.model.matches = 200;
  measurement.model.offset_px = offset_px;
  measurement.model.offset_sigma_px = 0.02;
  measurement.rms_before_px = offset_px + 0.05;
  measurement.rms_after_px = 0.05;
  return frame;
}

class Diagnostics : public testing::Test {
 protected:
  Diagnostics() { diagnostics_.setWanted(true, at(0)); }

  /// A pair every `period_s` from `start_s`, for 5 s, each processed immediately.
  void run(double start_s, double period_s, double age_ms = 100) {
    for (double time_s = start_s; time_s < start_s + 5; time_s += period_s) {
      diagnostics_.received(at(time_s));
      diagnostics_.processed(makeFrame(), at(time_s));
      diagnostics_.published(age_ms, at(time_s));
    }
  }

  StereoDiagnostics diagnostics_{{3, 1, 1}, "a.forest", 4};
};

TEST_F(Diagnostics, IdleIsNoFault) {
  diagnostics_.setWanted(false, at(1));
  for (const Describe describe :
       {&StereoDiagnostics::describeInput, &StereoDiagnostics::describeOutput,
        &StereoDiagnostics::describeCalibration, &StereoDiagnostics::describeMethod,
        &StereoDiagnostics::describeRectification}) {
    EXPECT_EQ(report(diagnostics_, describe, 100).level, DiagnosticStatus::OK);
  }
  expectHolds(report(diagnostics_, &StereoDiagnostics::describeInput, 100).message, "idle");
}

TEST_F(Diagnostics, WrongStampsAreNamedForAWhile) {
  run(0, 0.1);
  diagnostics_.stampsAreWrong("stamps went back on /left", at(5));
  const Report soon = report(diagnostics_, &StereoDiagnostics::describeInput, 6);
  EXPECT_EQ(soon.level, DiagnosticStatus::WARN);
  expectHolds(soon.message, "stamps went back on /left");
  run(11, 0.1);
  Report later = report(diagnostics_, &StereoDiagnostics::describeInput, 16);
  EXPECT_EQ(later.level, DiagnosticStatus::OK);
  EXPECT_EQ(later.values["last wrong stamps"], "stamps went back on /left");
}

TEST_F(Diagnostics, NameParametersThatWereNotTaken) {
  const char* key = "rejected parameters";
  EXPECT_EQ(report(diagnostics_, &StereoDiagnostics::describeMethod, 1).values[key], "none");
  diagnostics_.parametersDiffer("P1 is nan");
  EXPECT_EQ(report(diagnostics_, &StereoDiagnostics::describeMethod, 1).values[key], "P1 is nan");
}

TEST_F(Diagnostics, TellTheDisparitiesThatAreSearched) {
  ProcessedFrame frame = makeFrame();
  frame.result.range = {-4, 80};
  diagnostics_.processed(frame, at(1));
  EXPECT_EQ(report(diagnostics_, &StereoDiagnostics::describeMethod, 1).values["disparities"],
            "-4 ... 75 px");
  frame.range_is_automatic = true;
  diagnostics_.processed(frame, at(2));
  EXPECT_EQ(report(diagnostics_, &StereoDiagnostics::describeMethod, 2).values["disparities"],
            "-4 ... 75 px, found in the images");
}

TEST_F(Diagnostics, RatesAreThoseOfTheStream) {
  run(0, 0.25);
  const Report input = report(diagnostics_, &StereoDiagnostics::describeInput, 4.75);
  EXPECT_EQ(input.level, DiagnosticStatus::OK);
  expectHolds(input.message, "4.0 Hz");
  const Report output = report(diagnostics_, &StereoDiagnostics::describeOutput, 4.75);
  EXPECT_EQ(output.level, DiagnosticStatus::OK);
  EXPECT_EQ(output.values.at("results (Hz)"), "4.0");
  EXPECT_EQ(output.values.at("frames processed"), "20");
  EXPECT_EQ(output.values.at("age from stamp to publishing, mean (ms)"), "100.0");
}

TEST_F(Diagnostics, SilenceIsAnErrorAfterAWhile) {
  EXPECT_EQ(report(diagnostics_, &StereoDiagnostics::describeInput, 2.9).level,
            DiagnosticStatus::OK);
  diagnostics_.silent("left/image_rect nothing");
  const Report silent = report(diagnostics_, &StereoDiagnostics::describeInput, 7);
  EXPECT_EQ(silent.level, DiagnosticStatus::ERROR);
  expectHolds(silent.message, "no pair of images for 7 s");
  EXPECT_EQ(silent.values.at("report"), "left/image_rect nothing");
  diagnostics_.received(at(8));
  const Report alive = report(diagnostics_, &StereoDiagnostics::describeInput, 8);
  EXPECT_EQ(alive.level, DiagnosticStatus::OK);
  EXPECT_EQ(alive.values.at("report"), "");
}

TEST_F(Diagnostics, DropsAreCountedByCause) {
  diagnostics_.dropped(FrameDrop::kBusy, {}, at(1));
  EXPECT_EQ(report(diagnostics_, &StereoDiagnostics::describeOutput, 1).level,
            DiagnosticStatus::OK);
  diagnostics_.dropped(FrameDrop::kBadInput, "left and right are swapped", at(1));
  diagnostics_.dropped(FrameDrop::kBadInput, "left and right are swapped", at(2));
  const Report all = report(diagnostics_, &StereoDiagnostics::describeOutput, 2);
  EXPECT_EQ(all.level, DiagnosticStatus::ERROR);
  expectHolds(all.message, "all frames are dropped: left and right are swapped");
  diagnostics_.processed(makeFrame(), at(3));
  diagnostics_.dropped(FrameDrop::kFailed, "out of memory", at(4));
  const Report some = report(diagnostics_, &StereoDiagnostics::describeOutput, 4);
  EXPECT_EQ(some.level, DiagnosticStatus::WARN);
  expectHolds(some.message, "out of memory");
  EXPECT_EQ(some.values.at("frames dropped while busy"), "1");
  EXPECT_EQ(some.values.at("frames dropped for bad input"), "2");
  EXPECT_EQ(some.values.at("frames dropped after an error"), "1");
  EXPECT_EQ(report(diagnostics_, &StereoDiagnostics::describeOutput, 4 + 11).level,
            DiagnosticStatus::OK);
  const FrameCounts counts = diagnostics_.counts();
  EXPECT_EQ(counts.processed, 1U);
  EXPECT_EQ(counts.dropped_busy, 1U);
  EXPECT_EQ(counts.dropped_bad_input, 2U);
  EXPECT_EQ(counts.dropped_failed, 1U);
}

TEST_F(Diagnostics, OldResultsAndStampsOfTheFutureAreWarnings) {
  run(0, 0.5, 1500);
  const Report old = report(diagnostics_, &StereoDiagnostics::describeOutput, 4.5);
  EXPECT_EQ(old.level, DiagnosticStatus::WARN);
  expectHolds(old.message, "1.50 s old, more than warn_age_s = 1.00");
  run(20, 0.5, -50);
  const Report early = report(diagnostics_, &StereoDiagnostics::describeOutput, 24.5);
  EXPECT_EQ(early.level, DiagnosticStatus::WARN);
  expectHolds(early.message, "future");
}

TEST_F(Diagnostics, CalibrationTellsTheLastFaultAndWhen) {
  diagnostics_.dropped(FrameDrop::kBadInput, "right/camera_info has P[3] = 3", at(1));
  const Report bad = report(diagnostics_, &StereoDiagnostics::describeCalibration, 1);
  EXPECT_EQ(bad.level, DiagnosticStatus::ERROR);
  EXPECT_EQ(bad.message, "right/camera_info has P[3] = 3");
  diagnostics_.processed(makeFrame(), at(2));
  const Report good = report(diagnostics_, &StereoDiagnostics::describeCalibration, 6);
  EXPECT_EQ(good.level, DiagnosticStatus::OK);
  expectHolds(good.message, "700.0 px, baseline 0.1200 m");
  EXPECT_EQ(good.values.at("image size"), "64 x 48 px");
  EXPECT_EQ(good.values.at("last fault"), "right/camera_info has P[3] = 3");
  EXPECT_EQ(good.values.at("time since the last fault (s)"), "5");
  diagnostics_.dropped(FrameDrop::kFailed, "out of memory", at(7));  // not caused by the input
  EXPECT_EQ(report(diagnostics_, &StereoDiagnostics::describeCalibration, 7).level,
            DiagnosticStatus::OK);
}

TEST_F(Diagnostics, CalibrationTellsWarnings) {
  ProcessedFrame frame = makeFrame();
  frame.warnings = {"the baseline is 100 m", "cy differs"};
  diagnostics_.processed(frame, at(1));
  const Report doubtful = report(diagnostics_, &StereoDiagnostics::describeCalibration, 1);
  EXPECT_EQ(doubtful.level, DiagnosticStatus::WARN);
  EXPECT_EQ(doubtful.message, "the baseline is 100 m");
  EXPECT_EQ(doubtful.values.at("warning 1"), "the baseline is 100 m");
  EXPECT_EQ(doubtful.values.at("warning 2"), "cy differs");
}

TEST_F(Diagnostics, MethodTellsTimesMemoryForestAndThreads) {
  run(0, 0.5);
  const Report method = report(diagnostics_, &StereoDiagnostics::describeMethod, 4.5);
  EXPECT_EQ(method.level, DiagnosticStatus::OK);
  const std::map<std::string, std::string> expected = {
      {"forest", "a.forest"},         {"threads", "4"},
      {"total, mean (ms)", "102.0"},  {"total, largest (ms)", "102.0"},
      {"rectification (ms)", "1.0"},  {"volume (ms)", "20.0"},
      {"aggregation (ms)", "30.0"},   {"sgm (ms)", "40.0"},
      {"refinement (ms)", "5.0"},     {"selection (ms)", "6.0"},
      {"disparities", "0 ... 63 px"}, {"memory (MB)", "123"},
      {"rejected parameters", "none"}};
  EXPECT_EQ(method.values, expected);
}

TEST_F(Diagnostics, ARigThatIsKnockedOutOfCalibrationIsAWarning) {
  diagnostics_.processed(makeFrame(0.9), at(1));
  EXPECT_EQ(report(diagnostics_, &StereoDiagnostics::describeRectification, 1).level,
            DiagnosticStatus::OK);
  diagnostics_.processed(makeFrame(1.1), at(2));
  const Report knocked = report(diagnostics_, &StereoDiagnostics::describeRectification, 2);
  EXPECT_EQ(knocked.level, DiagnosticStatus::WARN);
  expectHolds(knocked.message,
              "the residual vertical offset is 1.10 px (RMS; at the center 1.10 +- 0.02 px)");
  expectHolds(knocked.message, "reduces it from 1.15 to 0.05 px");
  EXPECT_EQ(knocked.values.at("rms before correction (px)"), "1.150");
  EXPECT_EQ(knocked.values.at("rms after correction (px)"), "0.050");
  EXPECT_EQ(knocked.values.at("matches"), "200");
}

TEST_F(Diagnostics, WhatIsNotMeasuredIsNoWarning) {
  ProcessedFrame frame = makeFrame(5);
  frame.rectification.measurement.model.matches = 0;
  diagnostics_.processed(frame, at(1));
  const Report unknown = report(diagnostics_, &StereoDiagnostics::describeRectification, 1);
  EXPECT_EQ(unknown.level, DiagnosticStatus::OK);
  expectHolds(unknown.message, "not measured");
  EXPECT_TRUE(verticalOffsetWarning(makeFrame(5), 0).empty());  // no limit
}

TEST(RecentValues, ForgetsWhatIsOld) {
  RecentValues values;
  EXPECT_EQ(values.rateHz(at(0)), 0);
  EXPECT_EQ(values.mean(at(0)), 0);
  EXPECT_EQ(values.largest(at(0)), 0);
  values.add(at(0), 9);
  values.add(at(8), 2);
  values.add(at(9), 4);
  EXPECT_EQ(values.largest(at(9)), 9);
  EXPECT_EQ(values.count(at(11)), 2U);
  EXPECT_EQ(values.mean(at(11)), 3);
  EXPECT_EQ(values.largest(at(11)), 4);
  EXPECT_EQ(values.count(at(30)), 0U);
}

}  // namespace
}  // namespace cbmv
