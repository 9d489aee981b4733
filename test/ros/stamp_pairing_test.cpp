#include "ros/stamp_pairing.h"

#include <vector>

#include <boost/make_shared.hpp>
#include <gtest/gtest.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/Image.h>

namespace cbmv {
namespace {

using sensor_msgs::CameraInfo;
using sensor_msgs::Image;

template <typename Message>
boost::shared_ptr<const Message> at(double stamp_s) {
  auto message = boost::make_shared<Message>();
  message->header.stamp = ros::Time(stamp_s);
  return message;
}

/// With equal stamps, and with close ones.
class Pairing : public testing::TestWithParam<bool> {
 protected:
  void addLeft(double stamp_s) {
    pairing_.add<0>(at<Image>(stamp_s));
    pairing_.add<1>(at<CameraInfo>(stamp_s));
  }
  void addRight(double stamp_s) {
    pairing_.add<2>(at<Image>(stamp_s));
    pairing_.add<3>(at<CameraInfo>(stamp_s));
  }
  void addSet(double stamp_s) {
    addLeft(stamp_s);
    addRight(stamp_s);
  }
  /// More of one camera than may wait.
  void addLeftHours() {
    for (int i = 0; i < 8; ++i) {
      addLeft(5000 + i);
    }
  }

  using Stamps = std::vector<double>;
  Stamps paired_;
  StampPairing<Image, CameraInfo, Image, CameraInfo> pairing_{
      {5, GetParam(), 0.1},
      [this](const auto& first, const auto& second, const auto& third, const auto& fourth) {
        EXPECT_EQ(first->header.stamp, second->header.stamp);
        EXPECT_EQ(first->header.stamp, third->header.stamp);
        EXPECT_EQ(first->header.stamp, fourth->header.stamp);
        paired_.push_back(first->header.stamp.toSec());
      }};
};

TEST_P(Pairing, SetsComeAsTheyAreComplete) {
  addSet(1);
  addLeft(2);
  addSet(3);
  EXPECT_EQ(paired_, (Stamps{1, 3}));
}

/// Why there is dropAfter.
TEST_P(Pairing, WhatWaitsOfATimeToComeHoldsOthersUp) {
  if (GetParam()) {
    GTEST_SKIP() << "close stamps are paired in spite of it";
  }
  addLeftHours();
  addSet(1);
  EXPECT_EQ(paired_, Stamps{});
}

TEST_P(Pairing, NothingIsHeldUpAfterADrop) {
  addLeftHours();
  pairing_.dropAfter(ros::Time(1.5));
  addSet(1);
  EXPECT_EQ(paired_, Stamps{1});
}

TEST_P(Pairing, ADropLeavesWhatIsOfTheTime) {
  addLeftHours();
  pairing_.dropAfter(ros::Time(1.5));
  addLeft(1);
  pairing_.dropAfter(ros::Time(1.5));
  addRight(1);
  EXPECT_EQ(paired_, Stamps{1});
}

TEST_P(Pairing, ADropRepeatsNoSet) {
  addSet(1);
  addSet(2);
  pairing_.dropAfter(ros::Time(3));
  EXPECT_EQ(paired_, (Stamps{1, 2}));
}

TEST_P(Pairing, ClearedItBeginsAnew) {
  addLeft(1);
  pairing_.clear();
  addRight(1);
  EXPECT_EQ(paired_, Stamps{});
  addSet(2);
  EXPECT_EQ(paired_, Stamps{2});
}

/// message_filters ask for the time.
const bool kHasTime = [] {
  ros::Time::init();
  return true;
}();

INSTANTIATE_TEST_SUITE_P(Stamps, Pairing, testing::Bool(),
                         [](const auto& parameter) { return parameter.param ? "Close" : "Equal"; });

}  // namespace
}  // namespace cbmv
