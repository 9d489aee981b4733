#include "ros/stereo_inputs.h"

#include <utility>

#include <boost/bind/bind.hpp>

namespace cbmv {

using namespace boost::placeholders;  // NOLINT: message_filters takes boost::bind only

StereoInputs::StereoInputs(ros::NodeHandle& nh, ros::NodeHandle& private_nh, Callback callback)
    : nh_(nh), private_nh_(private_nh), transport_(nh), callback_(std::move(callback)) {
  private_nh_.param("queue_size", queue_size_, queue_size_);
  if (queue_size_ < 1) {
    throw Error(private_nh_.resolveName("queue_size") + " is " + std::to_string(queue_size_) +
                "; at least 1 would be right");
  }
  if (private_nh_.param("approximate_sync", false)) {
    approximate_ = makeSynchronizer<ApproximatePolicy>(queue_size_);
  } else {
    exact_ = makeSynchronizer<ExactPolicy>(queue_size_);
  }
  left_image_.registerCallback([this](const sensor_msgs::ImageConstPtr&) { ++received_[0]; });
  left_info_.registerCallback([this](const sensor_msgs::CameraInfoConstPtr&) { ++received_[1]; });
  right_image_.registerCallback([this](const sensor_msgs::ImageConstPtr&) { ++received_[2]; });
  right_info_.registerCallback([this](const sensor_msgs::CameraInfoConstPtr&) { ++received_[3]; });
}

template <typename Policy>
std::shared_ptr<message_filters::Synchronizer<Policy>> StereoInputs::makeSynchronizer(
    int queue_size) {
  auto synchronizer = std::make_shared<message_filters::Synchronizer<Policy>>(
      Policy(queue_size), left_image_, left_info_, right_image_, right_info_);
  synchronizer->registerCallback(boost::bind(&StereoInputs::receive, this, _1, _2, _3, _4));
  return synchronizer;
}

void StereoInputs::subscribe() {
  const image_transport::TransportHints hints("raw", ros::TransportHints(), private_nh_);
  left_image_.subscribe(transport_, "left/image_rect", queue_size_, hints);
  left_info_.subscribe(nh_, "left/camera_info", queue_size_);
  right_image_.subscribe(transport_, "right/image_rect", queue_size_, hints);
  right_info_.subscribe(nh_, "right/camera_info", queue_size_);
  describeSilence();
  subscribed_ = true;
}

void StereoInputs::unsubscribe() {
  left_image_.unsubscribe();
  left_info_.unsubscribe();
  right_image_.unsubscribe();
  right_info_.unsubscribe();
  subscribed_ = false;
}

StereoTopics StereoInputs::topics() const {
  return {nh_.resolveName("left/image_rect"), nh_.resolveName("left/camera_info"),
          nh_.resolveName("right/image_rect"), nh_.resolveName("right/camera_info")};
}

std::string StereoInputs::describeSilence() {
  std::array<std::uint64_t, 4> received{};
  for (std::size_t input = 0; input < received.size(); ++input) {
    received[input] = received_[input].exchange(0);
  }
  if (synchronized_.exchange(0) > 0 || !subscribed_) {
    return {};
  }
  const StereoTopics names = topics();
  return "no synchronised images: " + std::to_string(received[0]) + " messages on " +
         names.left_image + ", " + std::to_string(received[1]) + " on " + names.left_info + ", " +
         std::to_string(received[2]) + " on " + names.right_image + ", " +
         std::to_string(received[3]) + " on " + names.right_info +
         (exact_ ? "; their stamps have to be equal, or set the parameter approximate_sync"
                 : "; their stamps have to be close");
}

void StereoInputs::receive(const sensor_msgs::ImageConstPtr& left_image,
                           const sensor_msgs::CameraInfoConstPtr& left_info,
                           const sensor_msgs::ImageConstPtr& right_image,
                           const sensor_msgs::CameraInfoConstPtr& right_info) {
  ++synchronized_;
  callback_({left_image, left_info, right_image, right_info});
}

}  // namespace cbmv
