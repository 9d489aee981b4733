#include "ros/color_buffer.h"

#include <thread>

#include <boost/make_shared.hpp>
#include <gtest/gtest.h>

namespace cbmv {
namespace {

using std::chrono::milliseconds;

sensor_msgs::ImageConstPtr imageAt(double seconds) {
  auto image = boost::make_shared<sensor_msgs::Image>();
  image->header.stamp = ros::Time(seconds);
  return image;
}

TEST(ColorBuffer, FindsTheImageOfAStamp) {
  ColorBuffer buffer(5);
  const auto wanted = imageAt(2);
  buffer.add(imageAt(1));
  buffer.add(wanted);
  buffer.add(imageAt(3));
  EXPECT_EQ(buffer.find(ros::Time(2), milliseconds(0)), wanted);
  EXPECT_EQ(buffer.find(ros::Time(2.5), milliseconds(0)), nullptr);
}

TEST(ColorBuffer, ForgetsTheOldest) {
  ColorBuffer buffer(2);
  for (const double seconds : {1.0, 2.0, 3.0}) {
    buffer.add(imageAt(seconds));
  }
  EXPECT_EQ(buffer.find(ros::Time(1), milliseconds(0)), nullptr);
  EXPECT_NE(buffer.find(ros::Time(2), milliseconds(0)), nullptr);
}

TEST(ColorBuffer, WaitsForTheImage) {
  ColorBuffer buffer(5);
  const auto wanted = imageAt(2);
  std::thread camera([&] {
    std::this_thread::sleep_for(milliseconds(20));
    buffer.add(wanted);
  });
  EXPECT_EQ(buffer.find(ros::Time(2), milliseconds(5000)), wanted);
  camera.join();
}

TEST(ColorBuffer, DoesNotWaitForWhatIsPast) {
  ColorBuffer buffer(5);
  buffer.add(imageAt(3));
  const auto before = std::chrono::steady_clock::now();
  EXPECT_EQ(buffer.find(ros::Time(2), milliseconds(60000)), nullptr);
  EXPECT_LT(std::chrono::steady_clock::now() - before, milliseconds(30000));
}

TEST(ColorBuffer, WaitsWhereTimeHasGoneBack) {
  ColorBuffer buffer(5);
  buffer.add(imageAt(100));
  buffer.add(imageAt(1));
  const auto wanted = imageAt(2);
  std::thread camera([&] {
    std::this_thread::sleep_for(milliseconds(20));
    buffer.add(wanted);
  });
  EXPECT_EQ(buffer.find(ros::Time(2), milliseconds(5000)), wanted);
  camera.join();
}

TEST(ColorBuffer, GivesUp) {
  const ColorBuffer buffer(5);
  EXPECT_EQ(buffer.find(ros::Time(2), milliseconds(10)), nullptr);
}

}  // namespace
}  // namespace cbmv
