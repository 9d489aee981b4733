#include "ros/calibrated_pairs.h"

#include <string>
#include <vector>

#include <boost/make_shared.hpp>
#include <gtest/gtest.h>
#include <sensor_msgs/Image.h>

namespace cbmv {
namespace {

using sensor_msgs::CameraInfo;
using sensor_msgs::Image;

template <typename Message>
boost::shared_ptr<Message> at(double stamp_s) {
  auto message = boost::make_shared<Message>();
  message->header.stamp = ros::Time(stamp_s);
  return message;
}

/// Pairs passed on: the stamp of the pair and the names of the camera_infos.
using Sets = std::vector<std::string>;

class Calibration : public testing::Test {
 protected:
  void addPair(int stamp_s) {
    pairs_.addPair(at<Image>(stamp_s), at<Image>(stamp_s), ros::SteadyTime(now_s_));
  }
  void addInfo(std::size_t camera, int stamp_s, const std::string& name) {
    const auto info = at<CameraInfo>(stamp_s);
    info->header.frame_id = name;
    pairs_.addInfo(camera, info);
  }
  void addInfos(int stamp_s) {
    addInfo(0, stamp_s, std::to_string(stamp_s));
    addInfo(1, stamp_s, std::to_string(stamp_s));
  }
  /// Returns and clears the pairs passed on.
  Sets taken() { return std::exchange(sets_, {}); }

  double now_s_ = 100;
  Sets sets_;
  CalibratedPairs<Image, Image> pairs_{
      [this](const auto& left, const auto& left_info, const auto& right, const auto& right_info) {
        EXPECT_EQ(left->header.stamp, right->header.stamp);
        sets_.push_back(std::to_string(left->header.stamp.sec) + ": " + left_info->header.frame_id +
                        " " + right_info->header.frame_id);
      }};
};

TEST_F(Calibration, WithEveryImageIsNeverWaitedForInVain) {
  for (int i = 1; i < 10; ++i) {
    addInfos(i);
    addPair(i);
    const std::string name = std::to_string(i);
    EXPECT_EQ(taken(), Sets{name + ": " + name + " " + name});
  }
}

TEST_F(Calibration, OfEveryImageMayComeAfterIt) {
  for (int i = 1; i < 10; ++i) {
    addPair(i);
    addInfo(1, i, "right" + std::to_string(i));
    EXPECT_EQ(taken(), Sets{});
    addInfo(0, i, "left" + std::to_string(i));
    const std::string name = std::to_string(i);
    EXPECT_EQ(taken(), Sets{name + ": left" + name + " right" + name});
  }
}

TEST_F(Calibration, ThatComesOnceServesEveryImage) {
  addInfo(0, 0, "left");
  addInfo(1, 0, "right");
  Sets wanted;
  for (int i = 1; i <= 20; ++i) {
    addPair(i);
    wanted.push_back(std::to_string(i) + ": left right");
  }
  EXPECT_EQ(taken(), wanted);
  addPair(21);  // no longer waits
  EXPECT_EQ(taken(), Sets{"21: left right"});
}

TEST_F(Calibration, MayComeLaterThanTheImages) {
  addPair(1);
  addPair(2);
  EXPECT_EQ(taken(), Sets{});
  addInfo(0, 0, "left");
  addInfo(1, 0, "right");
  addPair(3);
  EXPECT_EQ(taken(), Sets{"2: left right"});
}

TEST_F(Calibration, OfOneCameraMayComeOnceAndOfTheOtherWithEveryImage) {
  addInfo(0, 0, "once");
  Sets wanted;
  for (int i = 1; i <= 10; ++i) {
    addPair(i);
    addInfo(1, i, std::to_string(i));
    wanted.push_back(std::to_string(i) + ": once " + std::to_string(i));
  }
  EXPECT_EQ(taken(), wanted);
}

TEST_F(Calibration, ThatComesSeldomIsTheNewest) {
  for (int i = 1; i <= 60; ++i) {
    if (i % 20 == 1) {
      addInfo(0, 1000 + i, "left" + std::to_string(i));
      addInfo(1, 1000 + i, "right" + std::to_string(i));
    }
    addPair(i);
  }
  const Sets sets = taken();
  ASSERT_EQ(sets.size(), 60U);
  EXPECT_EQ(sets[19], "20: left1 right1");
  EXPECT_EQ(sets[20], "21: left21 right21");
  EXPECT_EQ(sets[59], "60: left41 right41");
}

TEST_F(Calibration, ThatIsLostOnceIsReplacedByTheNewest) {
  for (int i = 1; i < 10; ++i) {
    addPair(i);
    if (i != 5) {
      addInfos(i);
    }
  }
  EXPECT_EQ(taken(), (Sets{"1: 1 1", "2: 2 2", "3: 3 3", "4: 4 4", "5: 4 4", "6: 6 6", "7: 7 7",
                           "8: 8 8", "9: 9 9"}));
}

TEST_F(Calibration, ComesWithEveryImageAgain) {
  addInfos(0);
  for (int i = 1; i <= 10; ++i) {
    addPair(i);
  }
  for (int i = 11; i <= 20; ++i) {  // each one late
    addPair(i);
    addInfos(i);
  }
  taken();
  addPair(21);
  EXPECT_EQ(taken(), Sets{});
  addInfos(21);
  EXPECT_EQ(taken(), Sets{"21: 21 21"});
}

TEST_F(Calibration, OfAnotherTimeIsWaitedForAgain) {
  addInfos(0);
  for (int i = 11; i <= 20; ++i) {
    addPair(i);
  }
  taken();
  addPair(1);
  EXPECT_EQ(taken(), Sets{});
  addInfos(1);
  EXPECT_EQ(taken(), Sets{"1: 1 1"});
}

TEST_F(Calibration, OfTheTimeBeforeServesAfterInputsWereClosed) {
  addInfo(0, 0, "left");
  addInfo(1, 0, "right");
  addPair(1);
  pairs_.clear();
  addPair(2);
  addPair(3);
  EXPECT_EQ(taken(), Sets{"2: left right"});
}

TEST_F(Calibration, IsNotWaitedForWithoutEnd) {
  addInfos(0);
  addPair(1);
  pairs_.handOverIfOverdue(ros::SteadyTime(now_s_ + 0.9 * decltype(pairs_)::kPatienceS));
  EXPECT_EQ(taken(), Sets{});
  pairs_.handOverIfOverdue(ros::SteadyTime(now_s_ + 1.1 * decltype(pairs_)::kPatienceS));
  EXPECT_EQ(taken(), Sets{"1: 0 0"});
}

TEST_F(Calibration, ThatNeverComesLeavesNothing) {
  addInfo(0, 0, "left");
  for (int i = 1; i <= 10; ++i) {
    addPair(i);
    pairs_.handOverIfOverdue(ros::SteadyTime(now_s_ + 10));
  }
  EXPECT_EQ(taken(), Sets{});
  addInfo(1, 10, "right");
  EXPECT_EQ(taken(), Sets{});
  pairs_.handOverIfOverdue(ros::SteadyTime(now_s_ + 10));
  EXPECT_EQ(taken(), Sets{"10: left right"});
}

}  // namespace
}  // namespace cbmv
