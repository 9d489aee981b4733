#include "ros/sync_monitor.h"

#include <gtest/gtest.h>

#include "support/error_text.h"

namespace cbmv {
namespace {

const SyncMonitor::TopicStates kStates = {
    {{"/s/left", true}, {"/s/left_info", true}, {"/s/right", true}, {"/s/right_info", false}}};
const std::array<std::string, kInputs> kNames = {"/a", "/a_info", "/b", "/b_info"};
const SyncOptions kEqual{5, false, 0.1};

ros::SteadyTime at(double seconds) { return ros::SteadyTime(100 + seconds); }

/// Ten seconds at 10 Hz on each of the first `topics` topics; stamps of topic i are late by i *
/// delay_s.
void receiveTenSeconds(SyncMonitor& monitor, std::size_t topics, double delay_s) {
  for (int frame = 0; frame < 100; ++frame) {
    for (std::size_t topic = 0; topic < topics; ++topic) {
      monitor.received(topic,
                       ros::Time(1000 + frame / 10.0 + static_cast<double>(topic) * delay_s));
    }
  }
}

TEST(SyncMonitor, IsSilentForSomeSeconds) {
  SyncMonitor monitor(kEqual);
  monitor.restart(at(0));
  EXPECT_EQ(monitor.report(at(SyncMonitor::kFirstReportS - 0.1), kStates), "");
  EXPECT_NE(monitor.report(at(SyncMonitor::kFirstReportS + 0.1), kStates), "");
}

TEST(SyncMonitor, SaysWhichTopicsArriveAtWhatRates) {
  SyncMonitor monitor(kEqual);
  monitor.restart(at(0));
  receiveTenSeconds(monitor, 2, 0);
  const std::string report = monitor.report(at(10), kStates);
  EXPECT_TRUE(mentions(report, {"10 s", "/s/left 10.0 Hz", "/s/left_info 10.0 Hz",
                                "/s/right no message (it has a publisher)",
                                "/s/right_info no message (no publisher)"}));
  EXPECT_EQ(report.find("approximate_sync"), std::string::npos) << report;  // not the cause
}

TEST(SyncMonitor, SaysHowFarStampsAreApart) {
  SyncMonitor monitor(kEqual);
  monitor.restart(at(0));
  receiveTenSeconds(monitor, 4, 0.004);
  const std::string report = monitor.report(at(10), kStates);
  EXPECT_TRUE(mentions(report, {"/s/left 10.0 Hz,", "/s/left_info 10.0 Hz,",
                                "/s/right 10.0 Hz (stamps 8.0 ms from the first topic's),",
                                "; the stamps are not equal", "approximate_sync to true",
                                "approximate_sync_max_interval_s to 0.012"}));
}

TEST(SyncMonitor, MeasuresToTheNearestStamp) {
  SyncMonitor monitor(kEqual);
  monitor.restart(at(0));
  receiveTenSeconds(monitor, 4, 0.049);  // 98 ms after one frame, but 2 ms before the next
  EXPECT_TRUE(mentions(monitor.report(at(10), kStates), {"(stamps 2.0 ms"}));
}

TEST(SyncMonitor, ClocksThatDifferAreNotApproximate) {
  SyncMonitor monitor(kEqual);
  monitor.restart(at(0));
  receiveTenSeconds(monitor, 4, 3600);
  const std::string report = monitor.report(at(10), kStates);
  EXPECT_TRUE(mentions(report, {"(stamps 2.0 h from", "clocks of the two sources differ"}));
  EXPECT_EQ(report.find("approximate_sync"), std::string::npos) << report;
}

TEST(SyncMonitor, SeesStampsThatAreNotSet) {
  SyncMonitor monitor(kEqual);
  monitor.restart(at(0));
  for (std::size_t input = 0; input < kInputs; ++input) {
    monitor.received(input, input == kSecond ? ros::Time() : ros::Time(1000));
  }
  EXPECT_TRUE(mentions(monitor.report(at(10), kStates), {"the stamps of /s/right are zero"}));
}

TEST(SyncMonitor, SeesTopicsThatComeLate) {
  SyncMonitor monitor(kEqual);
  monitor.restart(at(0));
  for (int frame = 0; frame < 60; ++frame) {
    for (std::size_t input = 0; input < kInputs; ++input) {
      monitor.received(input, ros::Time(1000 + frame - (input == kSecond ? 8 : 0)));
    }
  }
  EXPECT_TRUE(mentions(monitor.report(at(10), kStates), {"queue_size from 5 to 10"}));
}

TEST(SyncMonitor, AsksForCalibrations) {
  SyncMonitor monitor(kEqual);
  monitor.restart(at(0));
  monitor.received(kFirst, ros::Time(1));
  monitor.received(kSecond, ros::Time(1));
  monitor.received(kFirstInfo, ros::Time(0));
  const std::string report = monitor.report(at(10), kStates);
  EXPECT_TRUE(mentions(report, {"/s/right_info no message (no publisher); each camera needs",
                                "publish /s/right_info with every image or once (latched)"}));
  EXPECT_EQ(report.find("queue_size"), std::string::npos) << report;
}

TEST(SyncMonitor, OneCalibrationIsEnough) {
  SyncMonitor monitor(kEqual);
  monitor.restart(at(0));
  monitor.received(kFirstInfo, ros::Time(0));
  monitor.received(kSecondInfo, ros::Time(0));
  monitor.synchronized(at(1));
  const std::string report = monitor.report(at(10), kStates);
  EXPECT_TRUE(mentions(report, {"/s/right_info no new message (the last one is used)"}));
  EXPECT_EQ(report.find("calibration"), std::string::npos) << report;
}

TEST(SyncMonitor, NamesWhatToRemap) {
  SyncMonitor monitor(kEqual);
  monitor.restart(at(0));
  EXPECT_TRUE(mentions(
      monitor.report(at(10), {{{"/a", false}, {"/a_info", true}, {"/b", true}, {"/b_info", true}}}),
      {"/a no message (no publisher)",
       "; remap /a to the image topics (rostopic list shows them)"}));
}

TEST(SyncMonitor, ASetBeginsAnew) {
  SyncMonitor monitor(kEqual);
  monitor.restart(at(0));
  receiveTenSeconds(monitor, 4, 0);
  monitor.synchronized(at(9));
  EXPECT_EQ(monitor.report(at(10), kStates), "");
  EXPECT_TRUE(mentions(monitor.report(at(14), kStates), {"/s/left no message"}));
}

TEST(SyncMonitor, SlowCamerasAreReportedSeldom) {
  SyncMonitor monitor(kEqual);
  monitor.restart(at(0));
  EXPECT_NE(monitor.report(at(6), kStates), "");
  monitor.synchronized(at(10));
  EXPECT_EQ(monitor.report(at(16), kStates), "");
  monitor.restart(at(20));
  EXPECT_NE(monitor.report(at(26), kStates), "");
}

TEST(SyncMonitor, ReportsStampsOnce) {
  SyncMonitor monitor(kEqual);
  monitor.restart(at(0));
  EXPECT_EQ(monitor.reportStamps(kNames), "");
  for (const double stamp_s : {10.0, 7.5, 11.0, 10.0}) {
    monitor.received(kFirst, ros::Time(stamp_s));
  }
  for (int i = 0; i < 3; ++i) {
    monitor.received(kSecond, ros::Time(5));
    monitor.received(kSecondInfo, ros::Time(5));  // may be the same for all images
  }
  EXPECT_EQ(monitor.reportStamps(kNames),
            "stamps went back on /a (2.500 s), stamps were repeated on /b (2 times)");
  EXPECT_EQ(monitor.reportStamps(kNames), "");
  monitor.restart(at(1));
  monitor.received(kFirst, ros::Time(1));
  EXPECT_EQ(monitor.reportStamps(kNames), "");
}

TEST(SyncMonitor, MeasuresBetweenAnyStamps) {
  SyncMonitor monitor(kEqual);
  monitor.restart(at(0));
  monitor.received(kFirst, ros::Time(0, 1));
  monitor.received(kSecond, ros::Time(4294967295U, 0));
  EXPECT_TRUE(mentions(monitor.report(at(10), kStates), {"(stamps 136.1 years"}));
}

TEST(SyncMonitor, RepeatsItselfSeldom) {
  SyncMonitor monitor(kEqual);
  monitor.restart(at(0));
  EXPECT_NE(monitor.report(at(6), kStates), "");
  EXPECT_EQ(monitor.report(at(6 + SyncMonitor::kNextReportS - 1), kStates), "");
  EXPECT_NE(monitor.report(at(6 + SyncMonitor::kNextReportS), kStates), "");
}

}  // namespace
}  // namespace cbmv
