#pragma once

#include <ros/ros.h>

#include "ros/stereo_pair.h"

namespace cbmv {

/// Publishes the topics of a rectified stereo camera in a namespace.
class Cameras {
 public:
  explicit Cameras(ros::NodeHandle nh = ros::NodeHandle())
      : left_image_(nh.advertise<sensor_msgs::Image>("left/image_rect", 20)),
        left_info_(nh.advertise<sensor_msgs::CameraInfo>("left/camera_info", 20)),
        right_image_(nh.advertise<sensor_msgs::Image>("right/image_rect", 20)),
        right_info_(nh.advertise<sensor_msgs::CameraInfo>("right/camera_info", 20)),
        color_(nh.advertise<sensor_msgs::Image>("left/image_rect_color", 20)) {}

  void publish(const PairMessages& messages) {
    publishInfos(messages);
    left_image_.publish(messages.left_image);
    right_image_.publish(messages.right_image);
  }
  void publishLeft(const PairMessages& messages) {
    left_info_.publish(messages.left_info);
    left_image_.publish(messages.left_image);
  }
  void publishInfos(const PairMessages& messages) {
    left_info_.publish(messages.left_info);
    right_info_.publish(messages.right_info);
  }
  void publishColor(const sensor_msgs::ImageConstPtr& image) { color_.publish(image); }

  /// Whether every topic except the color image has a subscriber.
  bool pairIsWanted() const {
    return left_image_.getNumSubscribers() > 0 && left_info_.getNumSubscribers() > 0 &&
           right_image_.getNumSubscribers() > 0 && right_info_.getNumSubscribers() > 0;
  }
  bool infosAreWanted() const {
    return left_info_.getNumSubscribers() > 0 && right_info_.getNumSubscribers() > 0;
  }
  bool colorIsWanted() const { return color_.getNumSubscribers() > 0; }
  bool anyIsWanted() const {
    return left_image_.getNumSubscribers() > 0 || left_info_.getNumSubscribers() > 0 ||
           right_image_.getNumSubscribers() > 0 || right_info_.getNumSubscribers() > 0 ||
           colorIsWanted();
  }

 private:
  ros::Publisher left_image_;
  ros::Publisher left_info_;
  ros::Publisher right_image_;
  ros::Publisher right_info_;
  ros::Publisher color_;
};

}  // namespace cbmv
