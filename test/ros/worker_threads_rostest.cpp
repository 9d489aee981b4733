// Run by worker_threads.test: a nodelet that matches all the time, and another one, in a manager
// with one worker thread.

#include <algorithm>
#include <cstdio>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "ros/cameras.h"
#include "ros/collector.h"
#include "ros/rostest_main.h"
#include "ros/wait_for.h"

namespace cbmv {
namespace {

const cv::Size kBusySize(800, 600);  // takes a second and more
const cv::Size kLightSize(31, 22);

stereo_msgs::DisparityImage makeDisparity(const std_msgs::Header& header) {
  stereo_msgs::DisparityImage message;
  message.header = header;
  message.image = *makeImage(cv::Mat(kLightSize, CV_32FC1, cv::Scalar(5)), "32FC1", header);
  message.f = static_cast<float>(Rig().focal_length_px);
  message.T = static_cast<float>(Rig().baseline_m);
  message.max_disparity = 63;
  return message;
}

class WorkerThreads : public testing::Test {
 protected:
  WorkerThreads() : busy_(ros::NodeHandle("/busy")), light_(ros::NodeHandle("/light")) {
    light_disparity_ = nh_.advertise<stereo_msgs::DisparityImage>("/light/disparity", 5);
    disparity_.subscribe(nh_, "/busy/disparity");
    status_.subscribe(nh_, "/busy/status");
    cloud_.subscribe(nh_, "/light/points2");
  }

  bool allIsWanted() const {
    return busy_.pairIsWanted() && light_.infosAreWanted() && light_.colorIsWanted() &&
           light_disparity_.getNumSubscribers() > 0;
  }

  /// Seconds until the light nodelet has answered; while the other one always has the next frame.
  double answerTime() {
    busy_.publish(makeMessages(busy_pair_, {}, ros::Time::now()));
    const PairMessages sent = makeMessages(light_pair_, {}, ros::Time::now());
    light_.publishInfos(sent);
    light_.publishColor(sent.left_image);
    light_disparity_.publish(makeDisparity(sent.left_image->header));
    const ros::Time stamp = sent.left_image->header.stamp;
    EXPECT_TRUE(waitFor([&] { return cloud_.has(stamp); }, 60)) << "no answer at all";
    return (ros::Time::now() - stamp).toSec();
  }

  /// Of the fastest frame, s.
  double frameTime() const {
    double fastest_ms = std::numeric_limits<double>::infinity();
    status_.forEach([&](const cbmv_stereo::Status& status) {
      fastest_ms = std::min(fastest_ms, status.total_ms);
    });
    return fastest_ms / 1000;
  }

  ros::NodeHandle nh_;
  Cameras busy_;
  Cameras light_;
  ros::Publisher light_disparity_;
  Collector<stereo_msgs::DisparityImage> disparity_;
  Collector<cbmv_stereo::Status> status_;
  Collector<sensor_msgs::PointCloud2> cloud_;
  const StereoPair busy_pair_ = renderPair(kBusySize, 20, 60);
  const StereoPair light_pair_ = renderPair(kLightSize, 3, 6);
};

TEST_F(WorkerThreads, AreFreeWhileAFrameIsMatched) {
  ASSERT_TRUE(waitFor([&] { return allIsWanted(); }, 30));
  std::vector<double> answers_s;
  while (status_.count() < 3 && answers_s.size() < 5000) {
    answers_s.push_back(answerTime());
    wait(0.02);
  }
  ASSERT_GE(status_.count(), 3U);
  std::sort(answers_s.begin(), answers_s.end());
  std::printf("a frame takes %.2f s; %zu answers, median %.4f s, slowest %.4f s\n", frameTime(),
              answers_s.size(), answers_s[answers_s.size() / 2], answers_s.back());
  // Were a frame matched in the worker thread, an answer would wait for the whole of it.
  ASSERT_GT(frameTime(), 0.5) << "too fast to tell";
  EXPECT_LT(answers_s.back(), frameTime() / 2);
  EXPECT_GE(answers_s.size(), 20U);
}

}  // namespace
}  // namespace cbmv

int main(int argc, char** argv) { return cbmv::runRostest(argc, argv); }
