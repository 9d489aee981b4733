// Run by parity.test: nodelets of stereo_image_proc and of this package on the same input, in one
// manager.

#include <cmath>
#include <cstring>
#include <map>

#include <dynamic_reconfigure/Reconfigure.h>
#include <gtest/gtest.h>

#include "ros/cameras.h"
#include "ros/collector.h"
#include "ros/nodelet_manager.h"
#include "ros/rostest_main.h"
#include "ros/wait_for.h"

namespace cbmv {
namespace {

const cv::Size kSize(125, 81);
constexpr int kFarPx = 5;
constexpr int kNearPx = 11;
constexpr int kMinDisparity = 2;
constexpr int kDisparityRange = 32;

/// Sets the disparity range of a node as users of stereo_image_proc do.
void setRange(const std::string& node) {
  dynamic_reconfigure::Reconfigure call;
  for (const auto& [name, value] :
       {std::pair("min_disparity", kMinDisparity), std::pair("disparity_range", kDisparityRange)}) {
    dynamic_reconfigure::IntParameter parameter;
    parameter.name = name;
    parameter.value = value;
    call.request.config.ints.push_back(parameter);
  }
  ASSERT_TRUE(ros::service::waitForService(node + "/set_parameters", 20000));
  ASSERT_TRUE(ros::service::call(node + "/set_parameters", call));
}

/// Types of the topics that are published below a namespace, by relative name.
std::map<std::string, std::string> topicsOf(const std::string& name_space) {
  ros::master::V_TopicInfo all;
  ros::master::getTopics(all);
  std::map<std::string, std::string> topics;
  for (const auto& topic : all) {
    if (topic.name.rfind(name_space, 0) == 0) {
      topics[topic.name.substr(name_space.size())] = topic.datatype;
    }
  }
  return topics;
}

cv::Mat valuesOf(const stereo_msgs::DisparityImage& message) {
  return cv::Mat(static_cast<int>(message.image.height), static_cast<int>(message.image.width),
                 CV_32FC1, const_cast<std::uint8_t*>(message.image.data.data()),
                 message.image.step);
}

/// Outputs of both packages for the same frame.
class Parity : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    ASSERT_TRUE(waitForNodelets(4));
    setRange("/stock/disparity");
    setRange("/ours/disparity");
  }

  Parity() : cameras_(ros::NodeHandle("/cameras")) {}

  void subscribeAll() {
    stock_disparity_.subscribe(nh_, "/stock/disparity");
    our_disparity_.subscribe(nh_, "/ours/disparity");
    stock_cloud_.subscribe(nh_, "/stock/points2");
    our_cloud_.subscribe(nh_, "/ours/points2");
    mixed_cloud_.subscribe(nh_, "/mixed/points2");
    ASSERT_TRUE(waitFor([&] {
      return cameras_.pairIsWanted() && cameras_.colorIsWanted() &&
             stock_disparity_.isConnected() && our_disparity_.isConnected() &&
             stock_cloud_.isConnected() && our_cloud_.isConnected() && mixed_cloud_.isConnected();
    }));
  }

  /// Sends frames until one has come out of every nodelet. stereo_image_proc drops sets whose parts
  /// arrive in an unexpected order.
  void exchange() {
    subscribeAll();
    ASSERT_TRUE(waitFor(
        [&] {
          sent_ = makeMessages(renderPair(kSize, kFarPx, kNearPx), rig_, ros::Time::now());
          sent_.left_image->header.frame_id = "left_camera";
          stamp_ = sent_.left_image->header.stamp;
          color_ = cv::Mat(kSize, CV_8UC3);
          cv::randu(color_, 0, 256);
          cameras_.publishColor(makeImage(color_, "bgr8", sent_.left_image->header));
          wait(0.1);  // the color image is used only if it arrives in time
          cameras_.publish(sent_);
          return waitFor([&] { return allHaveCome(); }, 2);
        },
        20));
  }

  bool allHaveCome() const {
    return stock_disparity_.has(stamp_) && our_disparity_.has(stamp_) && stock_cloud_.has(stamp_) &&
           our_cloud_.has(stamp_) && mixed_cloud_.has(stamp_);
  }

  ros::NodeHandle nh_;
  Cameras cameras_;
  Rig rig_;
  PairMessages sent_;
  ros::Time stamp_;
  cv::Mat color_;
  Collector<stereo_msgs::DisparityImage> stock_disparity_;
  Collector<stereo_msgs::DisparityImage> our_disparity_;
  Collector<sensor_msgs::PointCloud2> stock_cloud_;
  Collector<sensor_msgs::PointCloud2> our_cloud_;
  Collector<sensor_msgs::PointCloud2> mixed_cloud_;
};

TEST_F(Parity, TopicsHaveTheSameNamesAndTypes) {
  const auto stock = topicsOf("/stock/");
  const auto ours = topicsOf("/ours/");
  EXPECT_EQ(stock.at("disparity"), "stereo_msgs/DisparityImage");
  EXPECT_EQ(stock.at("points2"), "sensor_msgs/PointCloud2");
  for (const auto& [name, type] : stock) {
    if (name.rfind("point_cloud2/", 0) != 0) {  // the bond of a nodelet that is not needed here
      ASSERT_EQ(ours.count(name), 1U) << name;
      EXPECT_EQ(ours.at(name), type) << name;
    }
  }
  EXPECT_EQ(topicsOf("/mixed/").at("points2"), "sensor_msgs/PointCloud2");
}

TEST_F(Parity, InputsAreSubscribedInTheSameCases) {
  EXPECT_FALSE(waitFor([&] { return cameras_.anyIsWanted(); }, 0.3));
  for (const std::string name_space : {"/stock", "/ours"}) {
    SCOPED_TRACE(name_space);
    our_disparity_.subscribe(nh_, name_space + "/disparity");
    EXPECT_TRUE(waitFor([&] { return cameras_.pairIsWanted(); }));
    EXPECT_FALSE(waitFor([&] { return cameras_.colorIsWanted(); }, 0.2));
    our_disparity_.unsubscribe();
    EXPECT_TRUE(waitFor([&] { return !cameras_.anyIsWanted(); }));
    our_cloud_.subscribe(nh_, name_space + "/points2");
    EXPECT_TRUE(waitFor([&] { return cameras_.pairIsWanted() && cameras_.colorIsWanted(); }));
    our_cloud_.unsubscribe();
    EXPECT_TRUE(waitFor([&] { return !cameras_.anyIsWanted(); }));
  }
}

TEST_F(Parity, DisparityImagesAgree) {
  ASSERT_NO_FATAL_FAILURE(exchange());
  const auto& stock = stock_disparity_.at(stamp_);
  const auto& ours = our_disparity_.at(stamp_);
  EXPECT_EQ(ours.header.stamp, stock.header.stamp);
  EXPECT_EQ(ours.header.frame_id, stock.header.frame_id);
  EXPECT_EQ(ours.image.header.stamp, stock.image.header.stamp);
  EXPECT_EQ(ours.image.header.frame_id, stock.image.header.frame_id);
  EXPECT_EQ(ours.image.width, stock.image.width);
  EXPECT_EQ(ours.image.height, stock.image.height);
  EXPECT_EQ(ours.image.encoding, stock.image.encoding);
  EXPECT_EQ(ours.image.is_bigendian, stock.image.is_bigendian);
  EXPECT_EQ(ours.image.step, stock.image.step);
  EXPECT_EQ(ours.image.data.size(), stock.image.data.size());
  EXPECT_EQ(ours.f, stock.f);
  EXPECT_EQ(ours.T, stock.T);
  EXPECT_GT(ours.T, 0);
  EXPECT_EQ(ours.min_disparity, stock.min_disparity);
  EXPECT_EQ(ours.max_disparity, stock.max_disparity);
  EXPECT_GT(ours.delta_d, 0);
  EXPECT_LE(ours.delta_d, stock.delta_d);  // 1/16 px there, finer here
}

TEST_F(Parity, ValidWindowLiesInTheImageHere) {
  ASSERT_NO_FATAL_FAILURE(exchange());
  const auto& stock =
      stock_disparity_.at(stamp_).valid_window;  // its sizes are not those of a window
  const auto& ours = our_disparity_.at(stamp_).valid_window;
  EXPECT_LE(ours.x_offset + ours.width, static_cast<unsigned>(kSize.width));
  EXPECT_GE(ours.width, static_cast<unsigned>(kSize.width - kMinDisparity));
  EXPECT_EQ(ours.y_offset, 0U);
  EXPECT_EQ(ours.height, static_cast<unsigned>(kSize.height));
  EXPECT_EQ(ours.do_rectify, stock.do_rectify);
  EXPECT_LE(ours.x_offset, stock.x_offset);
  EXPECT_LE(ours.y_offset, stock.y_offset);

  const auto& message = our_disparity_.at(stamp_);
  const cv::Mat found = valuesOf(message) >= message.min_disparity;
  const cv::Rect window(static_cast<int>(ours.x_offset), static_cast<int>(ours.y_offset),
                        static_cast<int>(ours.width), static_cast<int>(ours.height));
  EXPECT_EQ(cv::countNonZero(found), cv::countNonZero(found(window)));
}

TEST_F(Parity, DisparitiesAndTheInvalidValueAgree) {
  ASSERT_NO_FATAL_FAILURE(exchange());
  const cv::Mat stock = valuesOf(stock_disparity_.at(stamp_));
  const cv::Mat ours = valuesOf(our_disparity_.at(stamp_));
  const float lowest = stock_disparity_.at(stamp_).min_disparity;
  for (const cv::Mat& values : {stock, ours}) {
    const cv::Mat invalid = values < lowest;
    EXPECT_EQ(cv::countNonZero(invalid), cv::countNonZero(values == lowest - 1));
  }
  const cv::Mat found = (stock >= lowest) & (ours >= lowest);
  EXPECT_GT(cv::countNonZero(found), kSize.area() / 4);
  cv::Mat difference;
  cv::absdiff(stock, ours, difference);
  EXPECT_GT(cv::countNonZero((difference < 1) & found), 0.9 * cv::countNonZero(found));
}

void expectSameLayout(const sensor_msgs::PointCloud2& ours, const sensor_msgs::PointCloud2& stock) {
  EXPECT_EQ(ours.header.stamp, stock.header.stamp);
  EXPECT_EQ(ours.header.frame_id, stock.header.frame_id);
  EXPECT_EQ(ours.width, stock.width);
  EXPECT_EQ(ours.height, stock.height);
  EXPECT_EQ(ours.point_step, stock.point_step);
  EXPECT_EQ(ours.row_step, stock.row_step);
  EXPECT_EQ(ours.is_bigendian, stock.is_bigendian);
  EXPECT_EQ(ours.is_dense, stock.is_dense);
  EXPECT_EQ(ours.data.size(), stock.data.size());
  ASSERT_EQ(ours.fields.size(), stock.fields.size());
  for (std::size_t i = 0; i < stock.fields.size(); ++i) {
    EXPECT_EQ(ours.fields[i].name, stock.fields[i].name);
    EXPECT_EQ(ours.fields[i].offset, stock.fields[i].offset);
    EXPECT_EQ(ours.fields[i].datatype, stock.fields[i].datatype);
    EXPECT_EQ(ours.fields[i].count, stock.fields[i].count);
  }
}

TEST_F(Parity, CloudsHaveTheSameLayoutAndColors) {
  ASSERT_NO_FATAL_FAILURE(exchange());
  const auto& stock = stock_cloud_.at(stamp_);
  for (const sensor_msgs::PointCloud2& ours : {our_cloud_.at(stamp_), mixed_cloud_.at(stamp_)}) {
    ASSERT_NO_FATAL_FAILURE(expectSameLayout(ours, stock));
    for (std::size_t i = 0; i < ours.data.size(); i += ours.point_step) {
      ASSERT_EQ(std::memcmp(&ours.data[i + 16], &stock.data[i + 16], 4), 0) << "color";
    }
  }
}

std::array<float, 3> pointAt(const sensor_msgs::PointCloud2& cloud, std::size_t offset) {
  std::array<float, 3> point;
  std::memcpy(point.data(), &cloud.data[offset], sizeof(point));
  return point;
}

/// Both clouds from the stock disparity: this package's cloud has every point of the other.
TEST_F(Parity, CloudsOfOneDisparityHaveTheSamePoints) {
  ASSERT_NO_FATAL_FAILURE(exchange());
  const auto& stock = stock_cloud_.at(stamp_);
  const auto& ours = mixed_cloud_.at(stamp_);
  int found = 0;
  for (std::size_t i = 0; i < stock.data.size(); i += stock.point_step) {
    const auto theirs = pointAt(stock, i);
    const auto point = pointAt(ours, i);
    if (std::isnan(theirs[2])) {
      ASSERT_TRUE(std::isnan(theirs[0]) && std::isnan(theirs[1]));
      continue;
    }
    ++found;
    for (int axis = 0; axis < 3; ++axis) {
      ASSERT_NEAR(point[axis], theirs[axis], 1e-4 * theirs[2]);
    }
  }
  EXPECT_GT(found, kSize.area() / 4);
}

/// stereo_image_proc subtracts the offset twice in the disparity, and once more in the cloud.
TEST_F(Parity, OffsetOfVergedCamerasIsTakenOffOnceHere) {
  rig_.cx_right_px = rig_.cx_left_px + 3;
  ASSERT_NO_FATAL_FAILURE(exchange());
  const auto& ours = our_disparity_.at(stamp_);
  EXPECT_EQ(ours.min_disparity, kMinDisparity + 3);
  const cv::Point middle(kSize.width / 2, kSize.height / 2);
  EXPECT_NEAR(valuesOf(ours).at<float>(middle), kNearPx + 3, 0.5);
  EXPECT_NEAR(valuesOf(stock_disparity_.at(stamp_)).at<float>(middle), kNearPx + 6, 0.5);
  const auto offset = static_cast<std::size_t>(middle.y * kSize.width + middle.x) * 32;
  EXPECT_NEAR(pointAt(our_cloud_.at(stamp_), offset)[2], 120 * 0.25 / (kNearPx + 3), 0.1);
}

}  // namespace
}  // namespace cbmv

int main(int argc, char** argv) { return cbmv::runRostest(argc, argv); }
