#include "offline/bag_check.h"

#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "recording.h"
#include "support/error_text.h"

namespace cbmv {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class BagCheckTest : public testing::Test {
 protected:
  BagCheck check() { return checkBags(processingOf(input_, ""), fixtureForest()); }

  TemporaryFolder folder_;
  std::string input_ = folder_.file("in.bag");
};

TEST_F(BagCheckTest, TellsWhatIsThere) {
  writeRecording(input_, 3);
  const BagCheck found = check();
  EXPECT_THAT(found.problems, IsEmpty());
  EXPECT_TRUE(
      mentions(found.text, {"/stereo/left/image_rect  sensor_msgs/Image  3", "3 pairs",
                            "are treated as rectified: their names contain \"rect\"",
                            "focal length 120.0 px, baseline 0.2500 m", "96 x 64 px",
                            "up to 15 px: nearest depth 2.00 m", "ms wall time per frame"}));
}

TEST_F(BagCheckTest, TellsHowFarStampsAreApart) {
  PairMessages late = recordedFrame(5);
  late.right_image->header.stamp += ros::Duration(0.02);
  writeRecording(input_, 2, [&](rosbag::Bag& bag) { writeFrame(bag, late); });
  EXPECT_THAT(
      check().problems,
      ElementsAre(HasSubstr("1 left images have no right image with equal stamp; the nearest "
                            "is 0.020000 s away. Pair them with "
                            "--max-stamp-difference-s 0.021")));
}

TEST_F(BagCheckTest, TellsThatCamerasAreSwapped) {
  PairMessages messages = recordedFrame(0);
  std::swap(messages.left_info, messages.right_info);
  rosbag::Bag bag(input_, rosbag::bagmode::Write);
  writeFrame(bag, messages);
  bag.close();
  EXPECT_THAT(check().problems, ElementsAre(HasSubstr("/stereo/right/camera_info")));
}

TEST_F(BagCheckTest, TellsThatRowsAreNotAligned) {
  StereoPair pair = renderPair({320, 240}, 5, 11);
  pair.right = pair.right(cv::Rect(0, 2, 320, 238)).clone();
  pair.left = pair.left(cv::Rect(0, 0, 320, 238)).clone();
  rosbag::Bag bag(input_, rosbag::bagmode::Write);
  writeFrame(bag, makeMessages(pair, Rig{}, ros::Time(100)));
  bag.close();
  EXPECT_THAT(check().problems, ElementsAre(HasSubstr("vertical offset of the pair is 2.0")));
}

TEST_F(BagCheckTest, TellsThatTheBagIsDamaged) {
  writeRecording(input_, 6);
  std::filesystem::resize_file(input_, std::filesystem::file_size(input_) / 2);
  EXPECT_THAT(check().problems, testing::Contains(HasSubstr("rosbag reindex")));
}

}  // namespace
}  // namespace cbmv
