// Run by worker_threads.test: a nodelet that matches continuously and another one, in a manager
// with one worker thread.

#include <cstddef>
#include <cstdio>

#include <gtest/gtest.h>

#include "ros/cameras.h"
#include "ros/collector.h"
#include "ros/rostest_main.h"
#include "ros/wait_for.h"

namespace cbmv {
namespace {

const cv::Size kBusySize(800, 600);  // takes at least a second
const cv::Size kLightSize(31, 22);
constexpr std::size_t kFrames = 3;

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

  /// Waits until the light nodelet has answered; the other one always has the next frame.
  void waitForAnswer() {
    busy_.publish(makeMessages(busy_pair_, {}, ros::Time::now()));
    const PairMessages sent = makeMessages(light_pair_, {}, ros::Time::now());
    light_.publishInfos(sent);
    light_.publishColor(sent.left_image);
    light_disparity_.publish(makeDisparity(sent.left_image->header));
    const ros::Time stamp = sent.left_image->header.stamp;
    EXPECT_TRUE(waitFor([&] { return cloud_.has(stamp); }, 60)) << "no answer at all";
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
  std::size_t answers = 0;
  while (status_.count() < kFrames && answers < 100 * kFrames) {
    waitForAnswer();
    ++answers;
  }
  std::printf("%zu answers during %zu frames\n", answers, status_.count());
  // If a frame were matched in the worker thread, an answer would wait for its end.
  EXPECT_GE(answers, 5 * kFrames);
}

}  // namespace
}  // namespace cbmv

int main(int argc, char** argv) { return cbmv::runRostest(argc, argv); }
