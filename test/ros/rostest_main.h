#pragma once

#include <gtest/gtest.h>
#include <ros/ros.h>

namespace cbmv {

/// rostest counts the tests that failed. It does not see that a suite could not be set up, which
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

/// main() of the programs that rostest runs.
inline int runRostest(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  testing::AddGlobalTestEnvironment(new SuitesAreSetUp);  // googletest deletes it
  ros::init(argc, argv, "rostest");
  const ros::NodeHandle keeps_ros_alive;
  return RUN_ALL_TESTS();
}

}  // namespace cbmv
