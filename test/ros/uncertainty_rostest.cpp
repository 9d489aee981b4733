// Run by configuration.test: confidence and standard deviation of the outputs, on a rendered pair.
// If the test's forest provides the standard deviation, it is compared; otherwise the warning is
// expected.

#include <cmath>
#include <cstring>
#include <memory>

#include <gtest/gtest.h>

#include "ros/cameras.h"
#include "ros/collector.h"
#include "ros/local_nodelet.h"
#include "ros/log_reader.h"
#include "ros/rostest_main.h"
#include "ros/wait_for.h"
#include "support/forest_fixture.h"

#include "cbmv_stereo/stereo_matcher.h"

namespace cbmv {
namespace {

const cv::Size kSize(125, 81);
constexpr double kMinConfidence = 0.6;
const Rig kRig;

/// The pixels of a 32FC1 message.
cv::Mat_<float> floatsOf(const sensor_msgs::Image& message) {
  cv::Mat_<float> copy(static_cast<int>(message.height), static_cast<int>(message.width));
  CV_Assert(message.data.size() == copy.total() * sizeof(float));
  std::memcpy(copy.data, message.data.data(), message.data.size());
  return copy;
}

/// A field of all points; fails if it is not a float.
cv::Mat_<float> fieldOf(const sensor_msgs::PointCloud2& cloud, const std::string& name) {
  cv::Mat_<float> values(static_cast<int>(cloud.height), static_cast<int>(cloud.width), 0.0F);
  for (const auto& field : cloud.fields) {
    if (field.name == name) {
      EXPECT_EQ(field.datatype, sensor_msgs::PointField::FLOAT32);
      EXPECT_EQ(field.count, 1U);
      for (std::size_t i = 0; i < values.total(); ++i) {
        std::memcpy(values.data + 4 * i, &cloud.data[i * cloud.point_step + field.offset], 4);
      }
      return values;
    }
  }
  ADD_FAILURE() << "the cloud has no field " << name;
  return values;
}

/// Expects the same values, and NaN in the same places.
void expectSame(const cv::Mat_<float>& found, const cv::Mat_<float>& expected, const char* what) {
  ASSERT_EQ(found.size(), expected.size()) << what;
  for (int y = 0; y < found.rows; ++y) {
    for (int x = 0; x < found.cols; ++x) {
      if (std::isnan(expected(y, x))) {
        ASSERT_TRUE(std::isnan(found(y, x))) << what << " at " << x << ", " << y;
      } else {
        ASSERT_FLOAT_EQ(found(y, x), expected(y, x)) << what << " at " << x << ", " << y;
      }
    }
  }
}

class Uncertainty : public testing::Test {
 protected:
  void SetUp() override {
    nodelet_.parameters().setParam("forest", CBMV_TEST_FOREST);
    nodelet_.parameters().setParam("disparity_range", 16);
    nodelet_.parameters().setParam("refine_rectification", false);
    nodelet_.parameters().setParam("min_confidence", kMinConfidence);
    nodelet_.parameters().setParam("points_confidence", true);
    nodelet_.parameters().setParam("points_sigma", true);
    ASSERT_TRUE(nodelet_.load());
    disparity_.subscribe(nh_, "disparity");
    depth_.subscribe(nh_, "depth");
    confidence_.subscribe(nh_, "confidence");
    depth_sigma_.subscribe(nh_, "depth_sigma");
    points_.subscribe(nh_, "points2");
    ASSERT_TRUE(waitFor([&] {
      return cameras_.pairIsWanted() && disparity_.isConnected() && depth_.isConnected() &&
             confidence_.isConnected() && depth_sigma_.isConnected() && points_.isConnected();
    }));
    wait(0.2);  // until the node has all subscribers
  }

  /// Result of the core, without `min_confidence`.
  StereoResult expectedResult() const {
    StereoOptions options;
    options.range = {0, 16};
    options.rectification.enabled = false;
    StereoMatcher matcher(std::make_shared<const Forest>(makeForestFixture()), options);
    return matcher.match(pair_.left, pair_.right);
  }

  void publish() {
    cameras_.publish(sent_);
    ASSERT_TRUE(waitFor([&] {
      return disparity_.has(stamp_) && depth_.has(stamp_) && confidence_.has(stamp_) &&
             points_.has(stamp_);
    }));
  }

  void expectImage(const sensor_msgs::Image& message) const {
    EXPECT_EQ(message.header.stamp, stamp_);
    EXPECT_EQ(message.header.frame_id, sent_.left_image->header.frame_id);
    EXPECT_EQ(message.encoding, "32FC1");
    EXPECT_EQ(message.width, sent_.left_image->width);
    EXPECT_EQ(message.height, sent_.left_image->height);
    EXPECT_EQ(message.step, 4 * message.width);
  }

  void expectSigma(const StereoResult& expected) {
    ASSERT_TRUE(waitFor([&] { return depth_sigma_.has(stamp_); }));
    expectImage(depth_sigma_.at(stamp_));
    const cv::Mat_<float> sigma = floatsOf(depth_sigma_.at(stamp_));
    const double scale = kRig.focal_length_px * kRig.baseline_m;
    cv::Mat_<float> from_formula = floatsOf(depth_.at(stamp_));
    for (int y = 0; y < kSize.height; ++y) {
      for (int x = 0; x < kSize.width; ++x) {
        const double z = from_formula(y, x);
        from_formula(y, x) =
            static_cast<float>(z * z / scale * expected.disparity_sigma.at<float>(y, x));
      }
    }
    expectSame(sigma, from_formula, "depth_sigma");
    expectSame(fieldOf(points_.at(stamp_), "sigma"), sigma, "sigma");
  }

  void expectWarningsOfNoSigma() {
    for (const char* topic : {"/uncertainty_test/depth_sigma", "/uncertainty_test/points2"}) {
      EXPECT_TRUE(log_.waitForWarning({topic, "second forest", "/nodelet/forest"})) << topic;
    }
    EXPECT_EQ(depth_sigma_.count(), 0U);
    const cv::Mat_<float> none(kSize, std::numeric_limits<float>::quiet_NaN());
    expectSame(fieldOf(points_.at(stamp_), "sigma"), none, "sigma");
  }

  LogReader log_;
  LocalNodelet nodelet_{"uncertainty_test", "cbmv_stereo/stereo"};
  ros::NodeHandle nh_{"/uncertainty_test"};
  Cameras cameras_{nh_};
  Collector<stereo_msgs::DisparityImage> disparity_;
  Collector<sensor_msgs::Image> depth_;
  Collector<sensor_msgs::Image> confidence_;
  Collector<sensor_msgs::Image> depth_sigma_;
  Collector<sensor_msgs::PointCloud2> points_;
  StereoPair pair_ = renderPair(kSize, 4, 9);
  PairMessages sent_ = makeMessages(pair_, kRig, ros::Time::now());
  ros::Time stamp_ = sent_.left_image->header.stamp;
};

TEST_F(Uncertainty, OfTopicsAndCloudIsTheCores) {
  const StereoResult expected = expectedResult();
  const cv::Mat uncertain = expected.confidence < kMinConfidence;
  ASSERT_GT(cv::countNonZero(uncertain), 0);
  ASSERT_GT(cv::countNonZero(~uncertain), 0);
  publish();

  expectImage(depth_.at(stamp_));
  expectImage(confidence_.at(stamp_));
  expectSame(floatsOf(confidence_.at(stamp_)), expected.confidence, "confidence");
  const cv::Mat_<float> depth = floatsOf(depth_.at(stamp_));
  for (int y = 0; y < kSize.height; ++y) {
    for (int x = 0; x < kSize.width; ++x) {
      const bool is_masked = uncertain.at<std::uint8_t>(y, x) != 0;
      ASSERT_EQ(std::isnan(depth(y, x)), is_masked) << "at " << x << ", " << y;
    }
  }

  const sensor_msgs::PointCloud2& cloud = points_.at(stamp_);
  EXPECT_EQ(cloud.header.stamp, stamp_);
  EXPECT_EQ(cloud.header.frame_id, sent_.left_image->header.frame_id);
  expectSame(fieldOf(cloud, "z"), depth, "z");
  expectSame(fieldOf(cloud, "confidence"), expected.confidence, "confidence of the cloud");

  expected.disparity_sigma.empty() ? expectWarningsOfNoSigma() : expectSigma(expected);
}

}  // namespace
}  // namespace cbmv

int main(int argc, char** argv) { return cbmv::runRostest(argc, argv); }
