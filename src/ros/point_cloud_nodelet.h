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

/// One synchronized set of inputs for a cloud.
struct CloudMessages {
  sensor_msgs::ImageConstPtr color;
  sensor_msgs::CameraInfoConstPtr left_info;
  stereo_msgs::DisparityImageConstPtr disparity;
  sensor_msgs::CameraInfoConstPtr right_info;
};

/// Converts the disparity image of any node to a point cloud, with the topics and parameters of
/// stereo_image_proc/point_cloud2. Subscribes to its inputs only while the cloud has a subscriber.
class PointCloudNodelet : public nodelet::Nodelet {
 public:
  PointCloudNodelet() = default;
  ~PointCloudNodelet() override;

 private:
  /// Throws Error, and logs it as fatal, if the configuration is invalid.
  void onInit() override;
  void initialize();
  void stop();
  void updateSubscriptions();
  void reportInputs();

  // Called by the worker thread:
  void work(const CloudMessages& messages);
  sensor_msgs::PointCloud2 makeCloud(const CloudMessages& messages);
  cv::Mat colorOf(const CloudMessages& messages, cv::Size size);

  /// Logs at most one warning per cause and period.
  void warn(int cause, const std::string& message);

  CloudOptions options_;
  TopicNames topics_;               ///< resolved
  std::mutex subscriptions_mutex_;  ///< protects the members below
  bool stopping_ = false;
  std::unique_ptr<CloudInputs> inputs_;
  ros::Publisher publisher_;

  ros::WallTimer silence_timer_;
  WarningThrottle throttle_{5.0};
  std::unique_ptr<FrameWorker<CloudMessages>> worker_;  ///< stopped first
};

}  // namespace cbmv
