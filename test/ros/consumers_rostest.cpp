// Run by consumers.test: common nodelets process the outputs of this node, and compute the same
// points as its point cloud has.

#include <array>
#include <cmath>

#include <gtest/gtest.h>
#include <sensor_msgs/point_cloud2_iterator.h>

#include "ros/cameras.h"
#include "ros/collector.h"
#include "ros/rostest_main.h"
#include "ros/wait_for.h"

namespace cbmv {
namespace {

const cv::Size kSize(125, 81);

std::vector<std::array<float, 3>> pointsOf(const sensor_msgs::PointCloud2& cloud) {
  std::vector<std::array<float, 3>> points;
  for (sensor_msgs::PointCloud2ConstIterator<float> point(cloud, "x"); point != point.end();
       ++point) {
    points.push_back({point[0], point[1], point[2]});
  }
  return points;
}

class Consumers : public testing::Test {
 protected:
  Consumers() : cameras_(ros::NodeHandle("/cameras")) {
    ours_.subscribe(nh_, "/ours/points2");
    of_disparity_.subscribe(nh_, "/of_disparity/points2");
    of_depth_.subscribe(nh_, "/of_depth/points");
    of_depth_raw_.subscribe(nh_, "/of_depth_raw/points");
  }

  /// Sends frames until one has come out of every nodelet. The stock nodelets drop sets whose parts
  /// arrive in an unexpected order.
  void exchange() {
    ASSERT_TRUE(waitFor([&] { return cameras_.pairIsWanted() && cameras_.colorIsWanted(); }, 20));
    const StereoPair pair = renderPair(kSize, 4, 9);
    ASSERT_TRUE(waitFor(
        [&] {
          const PairMessages sent = makeMessages(pair, {}, ros::Time::now());
          stamp_ = sent.left_image->header.stamp;
          cameras_.publishColor(sent.left_image);
          cameras_.publish(sent);
          return waitFor([&] { return allHaveCome(); }, 2);
        },
        20));
  }

  bool allHaveCome() const {
    return ours_.has(stamp_) && of_disparity_.has(stamp_) && of_depth_.has(stamp_) &&
           of_depth_raw_.has(stamp_);
  }

  /// Compares the points of another nodelet with the node's cloud; depth may differ by `step_m`.
  /// Returns the number of points that are missing in the other cloud.
  int missingPoints(const sensor_msgs::PointCloud2& theirs, double step_m) {
    const sensor_msgs::PointCloud2& ours = ours_.at(stamp_);
    EXPECT_EQ(theirs.header.frame_id, ours.header.frame_id);
    EXPECT_EQ(theirs.width, ours.width);
    EXPECT_EQ(theirs.height, ours.height);
    const auto expected = pointsOf(ours);
    const auto found = pointsOf(theirs);
    EXPECT_EQ(found.size(), expected.size());
    int missing = 0;
    for (std::size_t i = 0; i < std::min(found.size(), expected.size()); ++i) {
      if (std::isnan(found[i][2])) {
        missing += std::isnan(expected[i][2]) ? 0 : 1;
        continue;
      }
      for (int axis = 0; axis < 3; ++axis) {
        EXPECT_NEAR(found[i][axis], expected[i][axis], step_m + 1e-4 * expected[i][2])
            << "point " << i;
      }
    }
    return missing;
  }

  ros::NodeHandle nh_;
  Cameras cameras_;
  ros::Time stamp_;
  Collector<sensor_msgs::PointCloud2> ours_;
  Collector<sensor_msgs::PointCloud2> of_disparity_;
  Collector<sensor_msgs::PointCloud2> of_depth_;
  Collector<sensor_msgs::PointCloud2> of_depth_raw_;
};

TEST_F(Consumers, MakeTheSamePoints) {
  ASSERT_NO_FATAL_FAILURE(exchange());
  // The cloud of stereo_image_proc lacks the pixels at the lowest disparity of a dense image.
  EXPECT_LT(missingPoints(of_disparity_.at(stamp_), 0), kSize.area() / 2);
  EXPECT_EQ(missingPoints(of_depth_.at(stamp_), 0), 0);
  EXPECT_EQ(missingPoints(of_depth_raw_.at(stamp_), 0.001), 0);  // whole millimeters
}

/// comparison.launch: both nodes get the same camera and the same disparity range.
TEST_F(Consumers, AreComparedOnOneCamera) {
  Collector<stereo_msgs::DisparityImage> ours, stock;
  ours.subscribe(nh_, "/comparison/cbmv/disparity");
  stock.subscribe(nh_, "/comparison/stock/disparity");
  Collector<sensor_msgs::PointCloud2> stock_cloud;
  stock_cloud.subscribe(nh_, "/comparison/stock/points2");
  const StereoPair pair = renderPair(kSize, 4, 9);
  ASSERT_TRUE(waitFor(
      [&] {
        const PairMessages sent = makeMessages(pair, {}, ros::Time::now());
        cameras_.publishColor(sent.left_image);
        cameras_.publish(sent);
        wait(0.5);
        return ours.count() > 0 && stock.count() > 0 && stock_cloud.count() > 0;
      },
      30));
  EXPECT_EQ(ours.newest().min_disparity, 1);
  EXPECT_EQ(stock.newest().min_disparity, 1);
  EXPECT_EQ(ours.newest().max_disparity, stock.newest().max_disparity);
}

}  // namespace
}  // namespace cbmv

int main(int argc, char** argv) { return cbmv::runRostest(argc, argv); }
