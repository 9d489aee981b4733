// Run by launch_names.test: images whose names differ from those of stereo_image_proc.

#include <string>

#include <gtest/gtest.h>

#include "ros/collector.h"
#include "ros/rostest_main.h"
#include "ros/stereo_pair.h"
#include "ros/wait_for.h"

namespace cbmv {
namespace {

class LaunchNames : public testing::TestWithParam<const char*> {};

TEST_P(LaunchNames, AreSubscribed) {
  ros::NodeHandle nh(std::string("/") + GetParam());
  const auto left = nh.advertise<sensor_msgs::Image>("infra1/image_rect_raw", 5);
  const auto right = nh.advertise<sensor_msgs::Image>("infra2/image_rect_raw", 5);
  const auto left_info = nh.advertise<sensor_msgs::CameraInfo>("infra1/camera_info", 5);
  const auto right_info = nh.advertise<sensor_msgs::CameraInfo>("infra2/camera_info", 5);
  Collector<stereo_msgs::DisparityImage> disparity;
  disparity.subscribe(nh, "disparity");
  const StereoPair pair = renderPair({61, 43}, 4, 9);
  EXPECT_TRUE(waitFor(
      [&] {
        const PairMessages messages = makeMessages(pair, {}, ros::Time::now());
        left_info.publish(messages.left_info);
        right_info.publish(messages.right_info);
        left.publish(messages.left_image);
        right.publish(messages.right_image);
        wait(0.1);
        return disparity.count() > 0;
      },
      20));
}

INSTANTIATE_TEST_SUITE_P(Ways, LaunchNames,
                         testing::Values("remapped", "names_remapped", "arguments", "nodelet"));

}  // namespace
}  // namespace cbmv

int main(int argc, char** argv) { return cbmv::runRostest(argc, argv); }
