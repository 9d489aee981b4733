#include "ros/sync_advice.h"

#include <gtest/gtest.h>

#include "support/error_text.h"

namespace cbmv {
namespace {

const SyncOptions kEqual{5, false, 0.1};
const SyncOptions kClose{5, true, 0.01};

StampRelation apart(double distance_s, double period_s = 0.1) {
  StampRelation relation;
  relation.first = "/left";
  relation.second = "/right";
  relation.distance_s = distance_s;
  relation.period_s = period_s;
  return relation;
}

bool suggestsApproximateSync(const std::string& advice) {
  return advice.find("approximate_sync") != std::string::npos;
}

TEST(SyncAdvice, CamerasWithoutTriggerNeedApproximateSync) {
  EXPECT_TRUE(mentions(syncAdvice(kEqual, apart(0.02)),
                       {"approximate_sync to true", "approximate_sync_max_interval_s to 0.03"}));
  EXPECT_TRUE(mentions(syncAdvice(kEqual, apart(0.4, 1)), {"_max_interval_s to 0.6"}));
  EXPECT_TRUE(mentions(syncAdvice(kClose, apart(0.02)),
                       {"increase", "approximate_sync_max_interval_s from 0.01 to 0.03"}));
}

TEST(SyncAdvice, ClocksThatDifferNeedToBeSynchronized) {
  for (const SyncOptions& options : {kEqual, kClose}) {
    for (const double distance_s : {0.11, 3.0, 50 * 365.25 * 86400}) {
      const std::string advice = syncAdvice(options, apart(distance_s));
      EXPECT_FALSE(suggestsApproximateSync(advice)) << advice;
      EXPECT_TRUE(mentions(advice, {"/left", "/right", "clocks of the two sources differ"}));
    }
  }
  EXPECT_TRUE(mentions(syncAdvice(kEqual, apart(50 * 365.25 * 86400)), {"50.0 years"}));
  EXPECT_FALSE(suggestsApproximateSync(syncAdvice(kEqual, apart(2, 10))));  // also for slow cameras
}

TEST(SyncAdvice, StampsThatAreNotSetAreNamed) {
  StampRelation relation = apart(1.7e9);
  relation.second_is_unset = true;
  EXPECT_TRUE(mentions(syncAdvice(kEqual, relation), {"stamps of /right are zero", "driver"}));
  relation = apart(1.7e9);
  relation.first_is_unset = true;
  EXPECT_TRUE(mentions(syncAdvice(kEqual, relation), {"stamps of /left are zero", "driver"}));
}

TEST(SyncAdvice, LateMessagesNeedALongerQueue) {
  StampRelation relation = apart(0);
  relation.lag = 20;
  EXPECT_TRUE(mentions(syncAdvice(kEqual, relation), {"queue_size from 5 to 22"}));
  EXPECT_TRUE(mentions(syncAdvice(kClose, apart(0.005)), {"queue_size from 5 to 10"}));
  EXPECT_TRUE(mentions(syncAdvice({5, true, 0}, apart(9)), {"queue_size"}));
}

TEST(Durations, HaveUnits) {
  EXPECT_EQ(durationText(0), "0.0 ms");
  EXPECT_EQ(durationText(0.004), "4.0 ms");
  EXPECT_EQ(durationText(1), "1.0 s");
  EXPECT_EQ(durationText(5400), "1.5 h");
  EXPECT_EQ(durationText(864000), "10.0 days");
  EXPECT_EQ(durationText(4294967295.0), "136.1 years");
}

}  // namespace
}  // namespace cbmv
