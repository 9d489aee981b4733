// Run by configuration.test: the nodelet cbmv_stereo/point_cloud2 on disparity images of any
// source.

#include <cmath>
#include <cstring>
#include <limits>

#include <gtest/gtest.h>

#include "ros/cameras.h"
#include "ros/collector.h"
#include "ros/local_nodelet.h"
#include "ros/log_reader.h"
#include "ros/rostest_main.h"
#include "ros/wait_for.h"

namespace cbmv {
namespace {

const cv::Size kSize(31, 22);
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

/// A disparity image according to the message definition, with f and T of Rig.
stereo_msgs::DisparityImage makeDisparity(const cv::Mat& values, float lowest,
                                          const std_msgs::Header& header) {
  stereo_msgs::DisparityImage message;
  message.header = header;
  message.image = *makeImage(values, "32FC1", header);
  message.f = static_cast<float>(Rig().focal_length_px);
  message.T = static_cast<float>(Rig().baseline_m);
  message.min_disparity = lowest;
  message.max_disparity = lowest + 63;
  message.delta_d = 0.0625F;
  return message;
}

class CloudOfDisparity : public ::testing::Test {
 protected:
  CloudOfDisparity() : nh_("/cloud"), nodelet_("cloud", "cbmv_stereo/point_cloud2"), cameras_(nh_) {
    disparity_ = nh_.advertise<stereo_msgs::DisparityImage>("disparity", 5);
  }

  void start() {
    ASSERT_TRUE(nodelet_.load());
    cloud_.subscribe(nh_, "points2");
    ASSERT_TRUE(waitFor([&] { return inputsAreWanted() && cloud_.isConnected(); }));
  }

  bool inputsAreWanted() const {
    return cameras_.infosAreWanted() && cameras_.colorIsWanted() &&
           disparity_.getNumSubscribers() > 0;
  }

  /// Sends one set; headers and camera_infos come from the pair.
  void send(const PairMessages& pair, const stereo_msgs::DisparityImage& disparity) {
    color_ = cv::Mat(disparityOf(disparity).size(), CV_8UC3);
    cv::randu(color_, 0, 256);
    cameras_.publishInfos(pair);
    cameras_.publishColor(makeImage(color_, "bgr8", pair.left_image->header));
    disparity_.publish(disparity);
  }

  static cv::Mat disparityOf(const stereo_msgs::DisparityImage& message) {
    return cv::Mat(static_cast<int>(message.image.height), static_cast<int>(message.image.width),
                   CV_32FC1, const_cast<std::uint8_t*>(message.image.data.data()));
  }

  PairMessages makePair(const Rig& rig = {}) {
    return makeMessages(renderPair(kSize, 1, 2), rig, ros::Time::now());
  }

  /// Sends values as a disparity image and compares the cloud point by point.
  void expectCloudOf(const cv::Mat& values, float lowest, const Rig& rig = {}) {
    const PairMessages pair = makePair(rig);
    send(pair, makeDisparity(values, lowest, pair.left_image->header));
    expectCloud(pair, values, lowest, rig);
  }

  void expectCloud(const PairMessages& pair, const cv::Mat& values, float lowest, const Rig& rig) {
    const ros::Time stamp = pair.left_image->header.stamp;
    ASSERT_TRUE(waitFor([&] { return cloud_.has(stamp); }));
    const sensor_msgs::PointCloud2& cloud = cloud_.at(stamp);
    EXPECT_EQ(cloud.header.frame_id, pair.left_image->header.frame_id);
    ASSERT_EQ(cloud.width, static_cast<unsigned>(values.cols));
    ASSERT_EQ(cloud.height, static_cast<unsigned>(values.rows));
    EXPECT_EQ(cloud.point_step, 32U);
    for (int y = 0; y < values.rows; ++y) {
      for (int x = 0; x < values.cols; ++x) {
        const std::uint8_t* bytes = &cloud.data[y * cloud.row_step + x * 32];
        std::array<float, 3> point;
        std::memcpy(point.data(), bytes, sizeof(point));
        const double d = values.at<float>(y, x);
        if (std::isfinite(d) && d >= lowest && d > 0) {
          const double z = rig.focal_length_px * rig.baseline_m / d;
          ASSERT_FLOAT_EQ(point[0],
                          static_cast<float>((x - rig.cx_left_px) * z / rig.focal_length_px));
          ASSERT_FLOAT_EQ(point[1], static_cast<float>((y - rig.cy_px) * z / rig.focal_length_px));
          ASSERT_FLOAT_EQ(point[2], static_cast<float>(z));
        } else {
          ASSERT_TRUE(std::isnan(point[0]) && std::isnan(point[1]) && std::isnan(point[2]));
        }
        ASSERT_EQ(cv::Vec3b(bytes[16], bytes[17], bytes[18]), color_.at<cv::Vec3b>(y, x));
      }
    }
  }

  static cv::Mat twoPlanes(float far_px, float near_px) {
    cv::Mat values(kSize, CV_32FC1, cv::Scalar(far_px));
    values(cv::Rect(8, 6, 12, 9)).setTo(near_px);
    return values;
  }

  ros::NodeHandle nh_;
  LocalNodelet nodelet_;
  Cameras cameras_;
  ros::Publisher disparity_;
  Collector<sensor_msgs::PointCloud2> cloud_;
  cv::Mat color_;
};

TEST_F(CloudOfDisparity, IsLazy) {
  ASSERT_TRUE(nodelet_.load());
  EXPECT_FALSE(waitFor([&] { return inputsAreWanted(); }, 0.3));
  cloud_.subscribe(nh_, "points2");
  EXPECT_TRUE(waitFor([&] { return inputsAreWanted(); }));
  cloud_.unsubscribe();
  EXPECT_TRUE(
      waitFor([&] { return !cameras_.anyIsWanted() && disparity_.getNumSubscribers() == 0; }));
}

TEST_F(CloudOfDisparity, FarthestPlaneOfADenseDisparityStays) {
  start();
  expectCloudOf(twoPlanes(4, 9), 4);
}

TEST_F(CloudOfDisparity, EveryMarkOfInvalidPixelsIsUnderstood) {
  start();
  cv::Mat values = twoPlanes(4, 9);
  const float infinity = std::numeric_limits<float>::infinity();
  values.row(0).setTo(3);     // just below the range
  values.row(1).setTo(3.5F);  // another value below it
  values.row(2).setTo(kNan);
  values.row(3).setTo(infinity);
  values.row(4).setTo(-infinity);
  expectCloudOf(values, 4);
}

TEST_F(CloudOfDisparity, OffsetOfVergedCamerasIsNotTakenOffAgain) {
  start();
  Rig rig;
  rig.cx_right_px = 52.5;  // 10 px less; already subtracted in the message's disparities
  expectCloudOf(twoPlanes(4, 9), 0, rig);
}

TEST_F(CloudOfDisparity, NegativeMinimumDisparity) {
  start();
  cv::Mat values = twoPlanes(3, 9);
  values.row(0).setTo(-6);  // valid, but beyond infinity
  values.row(1).setTo(-9);  // invalid
  expectCloudOf(values, -8);
}

TEST_F(CloudOfDisparity, CalibrationMayComeOnce) {
  start();
  const cv::Mat values = twoPlanes(4, 9);
  const PairMessages calibration = makePair();
  cameras_.publishInfos(calibration);
  for (int i = 0; i < 3; ++i) {
    PairMessages pair = makePair();
    const auto disparity = makeDisparity(values, 4, pair.left_image->header);
    color_ = cv::Mat(kSize, CV_8UC3, cv::Scalar(1, 2, 3));
    cameras_.publishColor(makeImage(color_, "bgr8", pair.left_image->header));
    disparity_.publish(disparity);
    expectCloud(pair, values, 4, {});
  }
}

TEST_F(CloudOfDisparity, UnknownPrivateParametersAreNamed) {
  LogReader log;
  wait(0.3);  // until the subscription is established
  nodelet_.parameters().setParam("queue_sise", 7);
  start();
  EXPECT_TRUE(log.waitForWarning({"queue_sise is not a parameter", "queue_size"}));
}

TEST_F(CloudOfDisparity, RegionOfInterestAndBinning) {
  start();
  const Rig rig{120, 0.25, (140 - 20) / 2.0, (140 - 30) / 2.0, (100 - 12) / 2.0};
  const PairMessages pair = makePair(rig);
  for (const auto& info : {pair.left_info, pair.right_info}) {
    info->width = 400;
    info->height = 300;
    info->binning_x = info->binning_y = 2;
    info->roi.width = 2 * 31;
    info->roi.height = 2 * 22;
    info->roi.y_offset = 12;
    info->P[0] = info->P[5] = 240;
    info->P[2] = 140;
    info->P[6] = 100;
  }
  pair.right_info->P[3] = -240 * 0.25;
  pair.left_info->roi.x_offset = 20;
  pair.right_info->roi.x_offset = 30;
  const cv::Mat values = twoPlanes(4, 9);
  send(pair, makeDisparity(values, 0, pair.left_image->header));
  expectCloud(pair, values, 0, rig);
}

TEST_F(CloudOfDisparity, CalibrationServesWhereTheMessageHasNoFocalLengthAndBaseline) {
  start();
  const PairMessages pair = makePair();
  const cv::Mat values = twoPlanes(4, 9);
  auto message = makeDisparity(values, 0, pair.left_image->header);
  message.f = 0;
  message.T = kNan;
  send(pair, message);
  expectCloud(pair, values, 0, {});
}

TEST_F(CloudOfDisparity, DropsBadInputWithAWarningAndLives) {
  start();
  LogReader log;
  PairMessages pair = makePair();
  pair.right_info->P.assign(0);
  send(pair, makeDisparity(twoPlanes(4, 9), 0, pair.left_image->header));
  EXPECT_TRUE(log.waitForWarning({"/cloud/right/camera_info", "Calibrate"}));
  pair = makePair();
  send(pair, makeDisparity(cv::Mat(9, 9, CV_32FC1), 0, pair.left_image->header));
  EXPECT_TRUE(log.waitForWarning({"/cloud/left/camera_info", "31 x 22", "9 x 9"}));
  pair = makePair();
  pair.right_info->header.frame_id = "right_camera";  // has no effect here
  const cv::Mat values = twoPlanes(4, 9);
  send(pair, makeDisparity(values, 0, pair.left_image->header));
  expectCloud(pair, values, 0, {});
}

TEST_F(CloudOfDisparity, LayoutAndLimitsAreTheParameters) {
  nodelet_.parameters().setParam("points_compact", true);
  nodelet_.parameters().setParam("points_min_depth_m", 5);  // f T = 30: disparities of at most 6 px
  start();
  const PairMessages pair = makePair();
  send(pair, makeDisparity(twoPlanes(4, 9), 0, pair.left_image->header));
  const ros::Time stamp = pair.left_image->header.stamp;
  ASSERT_TRUE(waitFor([&] { return cloud_.has(stamp); }));
  const sensor_msgs::PointCloud2& cloud = cloud_.at(stamp);
  EXPECT_EQ(cloud.point_step, 16U);
  ASSERT_EQ(cloud.fields.size(), 4U);
  EXPECT_EQ(cloud.fields[3].offset, 12U);
  const auto depth_at = [&](std::size_t x, std::size_t y) {
    float z = 0;
    std::memcpy(&z, &cloud.data[y * cloud.row_step + x * 16 + 8], sizeof(z));
    return z;
  };
  EXPECT_EQ(depth_at(2, 2), 7.5F);
  EXPECT_TRUE(std::isnan(depth_at(10, 8)));
}

}  // namespace
}  // namespace cbmv

int main(int argc, char** argv) { return cbmv::runRostest(argc, argv); }
