// Run by frame_path.test: one raw stereo rig processed by the node, cbmv_bag and cbmv_match.

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <rosbag/bag.h>
#include <rosbag/view.h>

#include "io/camera_yaml.h"
#include "io/image_file.h"
#include "io/pfm.h"
#include "ros/collector.h"
#include "ros/nodelet_manager.h"
#include "ros/raw_rig.h"
#include "ros/rostest_main.h"
#include "ros/stereo_pair.h"
#include "ros/wait_for.h"
#include "support/run_tool.h"
#include "support/temporary_folder.h"

namespace cbmv {
namespace {

const cv::Size kSize(440, 320);
constexpr int kFarPx = 16;
constexpr int kNearPx = 40;
constexpr double kLeftPlaceM = 0.02;  // distance of the left camera from the reference, to the left

const Rig kRig{360, 0.1, 219.5, 219.5, 159.5};
const std::string kOptions = std::string("--forest ") + CBMV_SOURCE_DIR +
                             "/models/middlebury_small.forest --preset " + CBMV_SOURCE_DIR +
                             "/config/realtime.yaml";

/// The lens for images of twice the size.
Lens doubled(Lens lens) {
  lens.matrix = cv::Matx33d(2, 0, 0.5, 0, 2, 0.5, 0, 0, 1) * lens.matrix;
  return lens;
}

/// Images with distortion and rotation; both cameras are away from the reference, as KITTI's color
/// cameras.
PairMessages makeRawFrame(const StereoPair& pair, ros::Time stamp) {
  PairMessages messages = makeMessages(pair, kRig, stamp);
  makeRaw(doubled(kLeftLens), doubled(kRightLens), messages);
  for (const auto& info : {messages.left_info, messages.right_info}) {
    info->P[3] += kLeftPlaceM * kRig.focal_length_px;
  }
  return messages;
}

/// Messages that the node publishes for one frame.
struct LiveFrame {
  PairMessages raw;
  cv::Mat depth, disparity;
  stereo_msgs::DisparityImage message;
  cv::Mat left_rect, right_rect;
};

cv::Mat pixels(const sensor_msgs::Image& message, int type) {
  return cv::Mat(static_cast<int>(message.height), static_cast<int>(message.width), type,
                 const_cast<std::uint8_t*>(message.data.data()), message.step)
      .clone();
}

bool sameBits(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && a.type() == b.type() &&
         std::equal(a.datastart, a.dataend, b.datastart);
}

float medianOf(const cv::Mat& values) {
  std::vector<float> sorted;
  for (const float value : cv::Mat_<float>(values)) {
    if (std::isfinite(value)) {
      sorted.push_back(value);
    }
  }
  std::nth_element(sorted.begin(), sorted.begin() + sorted.size() / 2, sorted.end());
  return sorted.at(sorted.size() / 2);
}

/// Checks the middle of the near rectangle and of the distant plane below it.
void expectTrueDepth(const cv::Mat& depth) {
  const cv::Rect near(kSize.width / 3 + 20, kSize.height / 3 + 20, kSize.width / 3 - 40,
                      kSize.height / 3 - 40);
  const cv::Rect far(kSize.width / 3, 2 * kSize.height / 3 + 20, kSize.width / 3,
                     kSize.height / 3 - 60);
  const double scale = kRig.focal_length_px * kRig.baseline_m;
  EXPECT_NEAR(medianOf(depth(near)), scale / kNearPx, 0.005 * scale / kNearPx);
  EXPECT_NEAR(medianOf(depth(far)), scale / kFarPx, 0.005 * scale / kFarPx);
}

class FramePath : public testing::Test {
 protected:
  static void SetUpTestSuite() { live_ = new LiveFrame(receive()); }
  static void TearDownTestSuite() { delete live_; }

  static LiveFrame receive() {
    EXPECT_TRUE(waitForNodelets(7));
    ros::NodeHandle nh("/robot");
    RawCameras cameras("/robot", "left", "right");
    Collector<stereo_msgs::DisparityImage> disparity;
    Collector<sensor_msgs::Image> depth, left_rect, right_rect;
    disparity.subscribe(nh, "disparity");
    depth.subscribe(nh, "depth");
    left_rect.subscribe(nh, "left/image_rect");
    right_rect.subscribe(nh, "right/image_rect");
    const StereoPair pair = renderPair(kSize, kFarPx, kNearPx);
    LiveFrame frame;
    const bool complete = waitFor(
        [&] {
          frame.raw = makeRawFrame(pair, ros::Time::now());
          cameras.publish(frame.raw);
          wait(0.5);
          const ros::Time stamp = frame.raw.left_image->header.stamp;
          return disparity.has(stamp) && depth.has(stamp) && left_rect.has(stamp) &&
                 right_rect.has(stamp);
        },
        60);
    EXPECT_TRUE(complete) << "no frame came out of the live node";
    if (complete) {
      const ros::Time stamp = frame.raw.left_image->header.stamp;
      frame.message = disparity.at(stamp);
      frame.disparity = pixels(frame.message.image, CV_32FC1);
      frame.depth = pixels(depth.at(stamp), CV_32FC1);
      frame.left_rect = pixels(left_rect.at(stamp), CV_8UC1);
      frame.right_rect = pixels(right_rect.at(stamp), CV_8UC1);
    }
    return frame;
  }

  void SetUp() override { ASSERT_FALSE(live_->depth.empty()); }

  TemporaryFolder folder_;
  static LiveFrame* live_;
};
LiveFrame* FramePath::live_ = nullptr;

TEST_F(FramePath, LiveNodeTellsTheTrueDepth) {
  EXPECT_FLOAT_EQ(live_->message.T, kRig.baseline_m);
  expectTrueDepth(live_->depth);
}

TEST_F(FramePath, BagToolTellsTheSameBits) {
  {
    rosbag::Bag bag(folder_.file("in.bag"), rosbag::bagmode::Write);
    const ros::Time stamp = live_->raw.left_image->header.stamp;
    bag.write("/robot/left/image_raw", stamp, live_->raw.left_image);
    bag.write("/robot/left/camera_info", stamp, live_->raw.left_info);
    bag.write("/robot/right/image_raw", stamp, live_->raw.right_image);
    bag.write("/robot/right/camera_info", stamp, live_->raw.right_info);
  }
  const test::Outcome outcome =
      test::run("cbmv_bag", folder_.file("in.bag") + " --output " + folder_.file("out.bag") +
                                " --write disparity,depth " + kOptions);
  ASSERT_EQ(outcome.status, 0) << outcome.output;
  rosbag::Bag bag(folder_.file("out.bag"), rosbag::bagmode::Read);
  std::map<std::string, cv::Mat> found;
  for (const rosbag::MessageInstance& message : rosbag::View(bag)) {
    if (const auto disparity = message.instantiate<stereo_msgs::DisparityImage>()) {
      EXPECT_EQ(disparity->T, live_->message.T);
      found["disparity"] = pixels(disparity->image, CV_32FC1);
    } else if (const auto depth = message.instantiate<sensor_msgs::Image>()) {
      found["depth"] = pixels(*depth, CV_32FC1);
    }
  }
  EXPECT_TRUE(sameBits(found["disparity"], live_->disparity));
  EXPECT_TRUE(sameBits(found["depth"], live_->depth));
}

TEST_F(FramePath, MatchToolTellsTheSameBitsOfTheRectifiedImages) {
  writeImage(folder_.file("left.png"), live_->left_rect);
  writeImage(folder_.file("right.png"), live_->right_rect);
  writeCameraYaml(folder_.file("left.yaml"), toCameraCalibration(*live_->raw.left_info));
  writeCameraYaml(folder_.file("right.yaml"), toCameraCalibration(*live_->raw.right_info));
  const test::Outcome outcome =
      test::run("cbmv_match", folder_.file("left.png") + " " + folder_.file("right.png") +
                                  " --calibration " + folder_.file("left.yaml") +
                                  " --right-calibration " + folder_.file("right.yaml") +
                                  " --output " + folder_.file("out") + " " + kOptions);
  ASSERT_EQ(outcome.status, 0) << outcome.output;
  EXPECT_EQ(outcome.output, "");
  EXPECT_TRUE(sameBits(readPfm(folder_.file("out/disparity.pfm")), live_->disparity));
  EXPECT_TRUE(sameBits(readPfm(folder_.file("out/depth.pfm")), live_->depth));
}

}  // namespace
}  // namespace cbmv

int main(int argc, char** argv) { return cbmv::runRostest(argc, argv); }
