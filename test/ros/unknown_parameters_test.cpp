#include "ros/unknown_parameters.h"

#include <gtest/gtest.h>

#include "support/error_text.h"

namespace cbmv {
namespace {

const std::vector<std::string> kParameters = {"disparity_range", "P1", "sgm_iterations"};

TEST(UnknownNames, HaveANearestOne) {
  EXPECT_EQ(nearestName("dispartiy_range", kParameters), "disparity_range");
  EXPECT_EQ(nearestName("P2", kParameters), "P1");
  EXPECT_EQ(nearestName("sgm_iteration", kParameters), "sgm_iterations");
  EXPECT_EQ(nearestName("", kParameters), "P1");
  EXPECT_EQ(nearestName("P1", kParameters), "P1");
}

TEST(UnknownNames, OfLaunchFilesAreDescribed) {
  const auto messages = describeUnknownArguments(
      "queue_sise disparity_range dispartiy_range : left queue_size", kParameters);
  ASSERT_EQ(messages.size(), 3U);
  EXPECT_EQ(
      messages[0],
      "queue_sise is not an argument of the launch file and is ignored. Did you mean queue_size?");
  EXPECT_EQ(messages[1],
            "disparity_range is not an argument of the launch file and is ignored. It is a "
            "parameter. Set it as a private parameter of the node, in a preset, or with "
            "dynamic_reconfigure");
  EXPECT_EQ(messages[2],
            "dispartiy_range is not an argument of the launch file and is ignored. Did you mean "
            "the parameter disparity_range? Set it as a private parameter of the node, in a "
            "preset, or with dynamic_reconfigure");
}

TEST(UnknownNames, MayBeNone) {
  EXPECT_TRUE(describeUnknownArguments("", kParameters).empty());
  EXPECT_TRUE(describeUnknownArguments("__ns : left right", kParameters).empty());
}

}  // namespace
}  // namespace cbmv
