#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include <image_transport/image_transport.h>
#include <image_transport/subscriber_filter.h>
#include <message_filters/subscriber.h>
#include <message_filters/sync_policies/approximate_time.h>
#include <message_filters/sync_policies/exact_time.h>
#include <message_filters/synchronizer.h>
#include <ros/ros.h>

#include "ros/conversions.h"

namespace cbmv {

/// The four synchronised input topics left|right/image_rect and left|right/camera_info.
/// Private parameters: approximate_sync, queue_size, image_transport.
class StereoInputs {
 public:
  using Callback = std::function<void(const StereoMessages&)>;

  StereoInputs(ros::NodeHandle& nh, ros::NodeHandle& private_nh, Callback callback);

  int queueSize() const { return queue_size_; }
  bool isSubscribed() const { return subscribed_; }
  void subscribe();
  void unsubscribe();
  /// Resolved names; known after the first subscribe().
  StereoTopics topics() const;

  /// One sentence if inputs were expected since the last call and no synchronised set has come;
  /// empty otherwise. Says how many messages each topic had.
  std::string describeSilence();

 private:
  using Image = sensor_msgs::Image;
  using Info = sensor_msgs::CameraInfo;
  using ExactPolicy = message_filters::sync_policies::ExactTime<Image, Info, Image, Info>;
  using ApproximatePolicy =
      message_filters::sync_policies::ApproximateTime<Image, Info, Image, Info>;

  template <typename Policy>
  std::shared_ptr<message_filters::Synchronizer<Policy>> makeSynchronizer(int queue_size);
  void receive(const sensor_msgs::ImageConstPtr& left_image,
               const sensor_msgs::CameraInfoConstPtr& left_info,
               const sensor_msgs::ImageConstPtr& right_image,
               const sensor_msgs::CameraInfoConstPtr& right_info);

  ros::NodeHandle nh_;
  ros::NodeHandle private_nh_;
  image_transport::ImageTransport transport_;
  Callback callback_;
  int queue_size_ = 5;
  bool subscribed_ = false;

  image_transport::SubscriberFilter left_image_;
  image_transport::SubscriberFilter right_image_;
  message_filters::Subscriber<Info> left_info_;
  message_filters::Subscriber<Info> right_info_;
  std::shared_ptr<message_filters::Synchronizer<ExactPolicy>> exact_;
  std::shared_ptr<message_filters::Synchronizer<ApproximatePolicy>> approximate_;

  std::array<std::atomic<std::uint64_t>, 4> received_{};  ///< since the last describeSilence()
  std::atomic<std::uint64_t> synchronized_{0};            ///< likewise
};

}  // namespace cbmv
