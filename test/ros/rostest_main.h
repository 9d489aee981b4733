#pragma once

#include <gtest/gtest.h>
#include <ros/ros.h>

namespace cbmv {

/// Fails if a test suite could not be set up. rostest counts failed tests only, and such a suite
/// skips its tests.
class SuitesAreSetUp : public testing::Environment {
 public:
  void TearDown() override {
    const testing::UnitTest& tests = *testing::UnitTest::GetInstance();
    for (int i = 0; i < tests.total_test_suite_count(); ++i) {
      const testing::TestSuite& suite = *tests.GetTestSuite(i);
      EXPECT_FALSE(suite.ad_hoc_test_result().Failed()) << suite.name() << " was not set up";
    }
  }
};

/// main() of the rostest programs.
inline int runRostest(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  testing::AddGlobalTestEnvironment(new SuitesAreSetUp);  // googletest deletes it
  ros::init(argc, argv, "rostest");
  const ros::NodeHandle keeps_ros_alive;
  return RUN_ALL_TESTS();
}

}  // namespace cbmv
