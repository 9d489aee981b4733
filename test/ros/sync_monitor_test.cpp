#include "ros/sync_monitor.h"

#include <gtest/gtest.h>

#include "support/error_text.h"

namespace cbmv {
namespace {

const std::vector<SyncMonitor::TopicState> kStates = {
    {"/s/left", true}, {"/s/left_info", true}, {"/s/right", true}, {"/s/right_info", false}};

ros::SteadyTime at(double seconds) { return ros::SteadyTime(100 + seconds); }

/// Ten seconds at 10 Hz on each of the first `topics` topics; stamps of topic i are late by
/// i * delay_s.
void receiveTenSeconds(SyncMonitor& monitor, std::size_t topics, double delay_s) {
  for (int frame = 0; frame < 100; ++frame) {
    for (std::size_t topic = 0; topic < topics; ++topic) {
      monitor.received(topic,
                       ros::Time(1000 + frame / 10.0 + static_cast<double>(topic) * delay_s));
    }
  }
}

TEST(SyncMonitor, IsSilentForSomeSeconds) {
  SyncMonitor monitor(4, "");
  monitor.restart(at(0));
  EXPECT_EQ(monitor.report(at(SyncMonitor::kFirstReportS - 0.1), kStates), "");
  EXPECT_NE(monitor.report(at(SyncMonitor::kFirstReportS + 0.1), kStates), "");
}

TEST(SyncMonitor, SaysWhichTopicsArriveAtWhatRates) {
  SyncMonitor monitor(4, "the remedy");
  monitor.restart(at(0));
  receiveTenSeconds(monitor, 2, 0);
  const std::string report = monitor.report(at(10), kStates);
  EXPECT_TRUE(mentions(report, {"10 s", "/s/left 10.0 Hz", "/s/left_info 10.0 Hz",
                                "/s/right nothing (it has a publisher)",
                                "/s/right_info nothing (nobody publishes it)"}));
  EXPECT_EQ(report.find("the remedy"), std::string::npos) << report;  // stamps are not the trouble
}

TEST(SyncMonitor, SaysHowFarStampsAreApart) {
  SyncMonitor monitor(4, "the remedy");
  monitor.restart(at(0));
  receiveTenSeconds(monitor, 4, 0.004);
  EXPECT_TRUE(mentions(
      monitor.report(at(10), kStates),
      {"/s/left 10.0 Hz,", "/s/left_info 10.0 Hz (stamps 4.0 ms", "/s/right 10.0 Hz (stamps 8.0 ms",
       "/s/right_info 10.0 Hz (stamps 12.0 ms", "; the remedy"}));
}

TEST(SyncMonitor, MeasuresToTheNearestStamp) {
  SyncMonitor monitor(2, "");
  monitor.restart(at(0));
  receiveTenSeconds(monitor, 2, 0.098);  // 98 ms after one frame, but 2 ms before the next
  EXPECT_TRUE(mentions(monitor.report(at(10), {{"a", true}, {"b", true}}), {"(stamps 2.0 ms"}));
}

TEST(SyncMonitor, ASetBeginsAnew) {
  SyncMonitor monitor(4, "");
  monitor.restart(at(0));
  receiveTenSeconds(monitor, 4, 0);
  monitor.synchronized(at(9));
  EXPECT_EQ(monitor.report(at(10), kStates), "");
  EXPECT_TRUE(mentions(monitor.report(at(14), kStates), {"/s/left nothing"}));
}

TEST(SyncMonitor, SlowCamerasAreReportedSeldom) {
  SyncMonitor monitor(4, "");
  monitor.restart(at(0));
  EXPECT_NE(monitor.report(at(6), kStates), "");
  monitor.synchronized(at(10));
  EXPECT_EQ(monitor.report(at(16), kStates), "");
  monitor.restart(at(20));
  EXPECT_NE(monitor.report(at(26), kStates), "");
}

TEST(SyncMonitor, SeesTimeJumpBackOnATopic) {
  SyncMonitor monitor(2, "");
  monitor.restart(at(0));
  const auto receive = [&](double stamp_s, std::size_t topic = 0) {
    return monitor.received(topic, ros::Time(stamp_s));
  };
  EXPECT_FALSE(receive(100));
  EXPECT_FALSE(receive(90, 1));  // another topic
  EXPECT_FALSE(receive(100));
  EXPECT_FALSE(receive(100 - 0.9 * SyncMonitor::kJumpS));
  EXPECT_FALSE(receive(100));
  EXPECT_TRUE(receive(100 - 1.1 * SyncMonitor::kJumpS));
  EXPECT_TRUE(receive(0));
  EXPECT_FALSE(receive(4294967295.0));
  EXPECT_TRUE(receive(1));
  monitor.synchronized(at(1));
  EXPECT_TRUE(receive(0));
  monitor.restart(at(2));
  EXPECT_FALSE(receive(0));
}

TEST(SyncMonitor, ReportsStampsOnce) {
  SyncMonitor monitor(2, "");
  monitor.restart(at(0));
  EXPECT_EQ(monitor.reportStamps({"/a", "/b"}), "");
  for (const double stamp_s : {10.0, 7.5, 11.0, 10.0}) {
    monitor.received(0, ros::Time(stamp_s));
  }
  for (int i = 0; i < 3; ++i) {
    monitor.received(1, ros::Time(5));
  }
  EXPECT_EQ(monitor.reportStamps({"/a", "/b"}),
            "stamps went back on /a (2.500 s), stamps came twice on /b (2 times)");
  EXPECT_EQ(monitor.reportStamps({"/a", "/b"}), "");
}

TEST(SyncMonitor, MeasuresBetweenAnyStamps) {
  SyncMonitor monitor(2, "");
  monitor.restart(at(0));
  monitor.received(0, ros::Time(0));
  monitor.received(1, ros::Time(4294967295U, 0));
  EXPECT_TRUE(
      mentions(monitor.report(at(10), {{"a", true}, {"b", true}}), {"(stamps 4294967295000.0 ms"}));
}

TEST(SyncMonitor, RepeatsItselfSeldom) {
  SyncMonitor monitor(4, "");
  monitor.restart(at(0));
  EXPECT_NE(monitor.report(at(6), kStates), "");
  EXPECT_EQ(monitor.report(at(6 + SyncMonitor::kNextReportS - 1), kStates), "");
  EXPECT_NE(monitor.report(at(6 + SyncMonitor::kNextReportS), kStates), "");
}

}  // namespace
}  // namespace cbmv
