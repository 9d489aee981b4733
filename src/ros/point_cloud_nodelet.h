#pragma once

#include <memory>
#include <mutex>
#include <string>

#include <nodelet/nodelet.h>
#include <ros/ros.h>
#include <stereo_msgs/DisparityImage.h>

#include "base/frame_worker.h"
#include "ros/nodelet_inputs.h"
#include "ros/point_cloud.h"
#include "ros/warning_throttle.h"

namespace cbmv {

/// One synchronised set of inputs of a cloud.
struct CloudMessages {
  sensor_msgs::ImageConstPtr color;
  sensor_msgs::CameraInfoConstPtr left_info;
  stereo_msgs::DisparityImageConstPtr disparity;
  sensor_msgs::CameraInfoConstPtr right_info;
};

/// Makes a cloud of the disparity image of any node, with the topics and parameters of
/// stereo_image_proc/point_cloud2. Inputs are subscribed only while the cloud has a subscriber.
class PointCloudNodelet : public nodelet::Nodelet {
 public:
  PointCloudNodelet() = default;
  ~PointCloudNodelet() override;

 private:
  /// Throws Error, after having logged it as fatal, if the nodelet cannot work as configured.
  void onInit() override;
  void initialize();
  void stop();
  void updateSubscriptions();
  void reportInputs();

  // In the worker's thread
  void work(const CloudMessages& messages);
  sensor_msgs::PointCloud2 makeCloud(const CloudMessages& messages);
  cv::Mat colorOf(const CloudMessages& messages, cv::Size size);

  /// At most one warning per cause in a while.
  void warn(int cause, const std::string& sentence);

  CloudOptions options_;
  TopicNames topics_;               ///< resolved
  std::mutex subscriptions_mutex_;  ///< of what follows
  bool stopping_ = false;
  std::unique_ptr<CloudInputs> inputs_;
  ros::Publisher publisher_;

  ros::WallTimer silence_timer_;
  WarningThrottle throttle_{5.0};
  std::unique_ptr<FrameWorker<CloudMessages>> worker_;  ///< stops first
};

}  // namespace cbmv
