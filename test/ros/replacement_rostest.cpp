// Run by replacement.test: stereo_image_proc_replacement.launch on raw images.

#include <algorithm>
#include <cstring>
#include <vector>

#include <gtest/gtest.h>

#include "ros/collector.h"
#include "ros/nodelet_manager.h"
#include "ros/raw_rig.h"
#include "ros/rostest_main.h"
#include "ros/stereo_pair.h"
#include "ros/wait_for.h"

namespace cbmv {
namespace {

const cv::Size kSize(124, 82);
constexpr int kFarPx = 4;
constexpr int kNearPx = 10;
constexpr int kRowsDown = 8;  // vertical shift of the images by rectification

float medianOf(const cv::Mat& values) {
  std::vector<float> sorted;
  values.clone().reshape(1, 1).copyTo(sorted);
  std::nth_element(sorted.begin(), sorted.begin() + sorted.size() / 2, sorted.end());
  return sorted[sorted.size() / 2];
}

/// Raw images of a Bayer sensor with a reddish scene; rectification shifts them down.
PairMessages makeRedMessages(const StereoPair& pair, ros::Time stamp) {
  PairMessages messages = makeMessages(pair, {}, stamp);
  for (const auto& image : {messages.left_image, messages.right_image}) {
    image->encoding = "bayer_rggb8";
    for (std::uint32_t y = 0; y < image->height; ++y) {
      for (std::uint32_t x = 0; x < image->width; ++x) {
        if (x % 2 == 1 || y % 2 == 1) {
          image->data[y * image->step + x] /= 2;
        }
      }
    }
  }
  for (const auto& info : {messages.left_info, messages.right_info}) {
    info->distortion_model = "plumb_bob";
    info->D = {1e-6, 0, 0, 0, 0};  // without distortion, image_proc does not rectify
    info->R = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    info->K = {info->P[0], 0, info->P[2], 0, info->P[5], info->P[6] - kRowsDown, 0, 0, 1};
  }
  return messages;
}

const cv::Size kLargeSize(220, 160);
const Rig kLargeRig{180, 0.25, 109.5, 109.5, 79.5};
PairMessages makeDistortedMessages(const StereoPair& pair, ros::Time stamp) {
  PairMessages messages = makeMessages(pair, kLargeRig, stamp);
  makeRaw(kLeftLens, kRightLens, messages);
  for (std_msgs::Header* header : {&messages.right_image->header, &messages.right_info->header}) {
    header->frame_id = "right_camera";
  }
  return messages;
}

/// Fraction of the pixels, away from borders and depth edges, whose disparity is correct within 0.5
/// px.
double rightShare(const cv::Mat& disparity, const cv::Mat& truth) {
  constexpr int kAwayPx = 9;
  cv::Mat lowest, highest, difference;
  truth.convertTo(difference, CV_32F);
  const cv::Mat around = cv::Mat::ones(2 * kAwayPx + 1, 2 * kAwayPx + 1, CV_8UC1);
  cv::erode(difference, lowest, around);
  cv::dilate(difference, highest, around);
  cv::Mat checked = lowest == highest;
  checked.colRange(0, 2 * kAwayPx) = 0;
  difference = cv::abs(difference - disparity) < 0.5;
  const int margin = kAwayPx;
  const cv::Rect inside(margin, margin, truth.cols - 2 * margin, truth.rows - 2 * margin);
  return cv::countNonZero((difference & checked)(inside)) /
         static_cast<double>(cv::countNonZero(checked(inside)));
}

using MakeMessages = PairMessages (*)(const StereoPair&, ros::Time);

/// Publishes the pair repeatedly until `has_arrived()`; returns false after a timeout.
template <typename Arrived>
bool publishUntil(RawCameras& cameras, const StereoPair& pair, MakeMessages make,
                  const Arrived& has_arrived) {
  return waitFor(
      [&] {
        cameras.publish(make(pair, ros::Time::now()));
        wait(0.2);
        return has_arrived();
      },
      30);
}

class Replacement : public testing::Test {
 protected:
  static void SetUpTestSuite() { ASSERT_TRUE(waitForNodelets(7)); }
};

TEST_F(Replacement, TakesLensDistortionOff) {
  ros::NodeHandle nh("/robot");
  RawCameras cameras("/robot", "port", "starboard");
  Collector<stereo_msgs::DisparityImage> disparity;
  disparity.subscribe(nh, "disparity");
  const StereoPair pair = renderPair(kLargeSize, 6, 14);
  ASSERT_TRUE(
      publishUntil(cameras, pair, makeDistortedMessages, [&] { return disparity.count() > 1; }));
  const stereo_msgs::DisparityImage& message = disparity.newest();
  EXPECT_EQ(message.header.frame_id, "left_camera");
  const cv::Mat values(kLargeSize, CV_32FC1, const_cast<std::uint8_t*>(message.image.data.data()));
  EXPECT_GT(rightShare(values, pair.disparity), 0.97);
}

TEST_F(Replacement, LeavesOutImprobableDisparities) {
  ros::NodeHandle nh("/robot");
  RawCameras cameras("/robot", "port", "starboard");
  Collector<stereo_msgs::DisparityImage> disparity;
  Collector<sensor_msgs::Image> confidence;
  disparity.subscribe(nh, "disparity");
  confidence.subscribe(nh, "confidence");
  const StereoPair pair = renderPair(kSize, kFarPx, kNearPx);
  ASSERT_TRUE(publishUntil(cameras, pair, makeRedMessages, [&] {
    return disparity.count() > 1 && confidence.count() > 1 &&
           disparity.newest().header.stamp == confidence.newest().header.stamp;
  }));
  const stereo_msgs::DisparityImage& message = disparity.newest();
  const sensor_msgs::Image& probabilities = confidence.newest();
  const cv::Mat values(kSize, CV_32FC1, const_cast<std::uint8_t*>(message.image.data.data()));
  const cv::Mat sure(kSize, CV_32FC1, const_cast<std::uint8_t*>(probabilities.data.data()));
  const cv::Mat left_out = values == message.min_disparity - 1;
  EXPECT_EQ(cv::countNonZero(left_out != (sure < 0.5F)), 0);
  EXPECT_GT(cv::countNonZero(left_out), 0);
  EXPECT_LT(cv::countNonZero(left_out), values.total() / 2);
}

TEST_F(Replacement, MakesTheStockTopicsOfRawImages) {
  ros::NodeHandle nh("/robot");
  RawCameras cameras("/robot", "port", "starboard");
  Collector<stereo_msgs::DisparityImage> disparity;
  Collector<sensor_msgs::PointCloud2> points;
  disparity.subscribe(nh, "disparity");
  points.subscribe(nh, "points2");
  const StereoPair pair = renderPair(kSize, kFarPx, kNearPx);
  ASSERT_TRUE(publishUntil(cameras, pair, makeRedMessages,
                           [&] { return disparity.count() > 1 && points.count() > 1; }));

  const stereo_msgs::DisparityImage& message = disparity.newest();
  EXPECT_EQ(message.header.frame_id, "left_camera");
  const cv::Mat values(kSize, CV_32FC1, const_cast<std::uint8_t*>(message.image.data.data()));
  const int top = kSize.height / 3;  // top of the near rectangle in the raw images
  const cv::Range middle(kSize.width / 3 + 5, 2 * kSize.width / 3 - 5);
  EXPECT_NEAR(medianOf(values({top + 1, top + kRowsDown - 1}, middle)), kFarPx, 0.5);
  EXPECT_NEAR(medianOf(values({2 * top + 1, 2 * top + kRowsDown - 1}, middle)), kNearPx, 0.5);

  const sensor_msgs::PointCloud2& cloud = points.newest();
  EXPECT_EQ(cloud.header.frame_id, "left_camera");
  const std::uint8_t* point =
      &cloud.data[static_cast<std::size_t>(3 * top / 2) * cloud.row_step + 62 * cloud.point_step];
  float z = 0;
  std::memcpy(&z, point + 8, sizeof(z));
  EXPECT_NEAR(z, 120 * 0.25 / kNearPx, 0.3);
  EXPECT_GT(point[18], point[16] + 10) << "the cloud is not red";
}

TEST_F(Replacement, HasTheTopicsAndNodesOfTheStockLaunchFile) {
  const auto has_topic = [](const std::string& name, const std::string& type) {
    return waitFor([&] {
      ros::master::V_TopicInfo topics;
      ros::master::getTopics(topics);
      return std::any_of(topics.begin(), topics.end(), [&](const ros::master::TopicInfo& topic) {
        return topic.name == name && topic.datatype == type;
      });
    });
  };
  EXPECT_TRUE(has_topic("/robot/disparity", "stereo_msgs/DisparityImage"));
  EXPECT_TRUE(has_topic("/robot/points2", "sensor_msgs/PointCloud2"));
  for (const std::string camera : {"port", "starboard"}) {
    for (const char* image : {"image_mono", "image_color", "image_rect", "image_rect_color"}) {
      EXPECT_TRUE(has_topic("/robot/" + camera + "/" + image, "sensor_msgs/Image")) << image;
    }
  }
  EXPECT_TRUE(ros::service::exists("/robot/disparity/set_parameters", true));
  bool approximate = false;
  EXPECT_TRUE(ros::param::get("/robot/disparity/approximate_sync", approximate));
  EXPECT_TRUE(approximate);
}

}  // namespace
}  // namespace cbmv

int main(int argc, char** argv) { return cbmv::runRostest(argc, argv); }
