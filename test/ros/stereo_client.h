#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include <dynamic_reconfigure/Reconfigure.h>
#include <ros/callback_queue.h>
#include <ros/ros.h>
#include <rosgraph_msgs/Log.h>

#include "ros/parameter_server.h"
#include "ros/stereo_pair.h"

#include "cbmv_stereo/pipeline/parameters.h"

namespace cbmv {

/// Calls back until `done` or until the time is over; returns whether it is done.
inline bool waitFor(const std::function<bool()>& done, double timeout_s = 10) {
  const ros::WallTime end = ros::WallTime::now() + ros::WallDuration(timeout_s);
  while (ros::ok() && !done() && ros::WallTime::now() < end) {
    ros::getGlobalCallbackQueue()->callAvailable(ros::WallDuration(0.01));
  }
  return done();
}

/// Keeps all messages of a topic, by stamp.
template <typename Message>
class Collector {
 public:
  void subscribe(ros::NodeHandle& nh, const std::string& topic) {
    subscriber_ =
        nh.subscribe<Message>(topic, 100, [this](const boost::shared_ptr<const Message>& message) {
          messages_[message->header.stamp] = message;
        });
  }
  void unsubscribe() { subscriber_.shutdown(); }
  bool isConnected() const { return subscriber_.getNumPublishers() > 0; }
  bool has(ros::Time stamp) const { return messages_.count(stamp) > 0; }
  const Message& at(ros::Time stamp) const { return *messages_.at(stamp); }
  std::size_t count() const { return messages_.size(); }

 private:
  ros::Subscriber subscriber_;
  std::map<ros::Time, boost::shared_ptr<const Message>> messages_;
};

/// The other side of the node: cameras, consumer, log reader and operator.
class StereoClient {
 public:
  StereoClient() {
    left_image_ = nh_.advertise<sensor_msgs::Image>("left/image_rect", 20);
    left_info_ = nh_.advertise<sensor_msgs::CameraInfo>("left/camera_info", 20);
    right_image_ = nh_.advertise<sensor_msgs::Image>("right/image_rect", 20);
    right_info_ = nh_.advertise<sensor_msgs::CameraInfo>("right/camera_info", 20);
    color_ = nh_.advertise<sensor_msgs::Image>("left/image_rect_color", 20);
    log_ = nh_.subscribe<rosgraph_msgs::Log>(
        "/rosout", 1000, [this](const boost::shared_ptr<const rosgraph_msgs::Log>& entry) {
          log_entries_.push_back(*entry);
        });
  }

  ~StereoClient() {
    unsubscribeAll();
    waitFor([this] { return !inputsAreWanted(); });
  }

  void subscribeAll() {
    withEach([this](auto& output, const char* topic) { output.subscribe(nh_, topic); });
  }

  void unsubscribeAll() {
    withEach([](auto& output, const char*) { output.unsubscribe(); });
  }

  /// Calls use(collector, topic) with each output.
  template <typename Use>
  void withEach(const Use& use) {
    use(disparity, "disparity");
    use(points, "points2");
    use(depth, "depth");
    use(depth_raw, "depth_raw");
    use(camera_info, "camera_info");
    use(confidence, "confidence");
    use(valid_mask, "valid_mask");
    use(disparity_color, "disparity_color");
    use(status, "status");
  }

  bool allConnected() {
    bool all = true;
    withEach([&](auto& output, const char*) { all = all && output.isConnected(); });
    return all;
  }
  bool allHave(ros::Time stamp) {
    bool all = true;
    withEach([&](auto& output, const char*) { all = all && output.has(stamp); });
    return all;
  }

  /// Whether every input, but the one for colour, has a subscriber.
  bool inputsAreWanted() const {
    return left_image_.getNumSubscribers() > 0 && left_info_.getNumSubscribers() > 0 &&
           right_image_.getNumSubscribers() > 0 && right_info_.getNumSubscribers() > 0;
  }
  bool anyInputIsWanted() const {
    return left_image_.getNumSubscribers() > 0 || left_info_.getNumSubscribers() > 0 ||
           right_image_.getNumSubscribers() > 0 || right_info_.getNumSubscribers() > 0 ||
           colorIsWanted();
  }
  bool colorIsWanted() const { return color_.getNumSubscribers() > 0; }

  void publish(const PairMessages& messages) {
    left_info_.publish(messages.left_info);
    right_info_.publish(messages.right_info);
    left_image_.publish(messages.left_image);
    right_image_.publish(messages.right_image);
  }
  void publishColor(const sensor_msgs::ImagePtr& image) { color_.publish(image); }

  /// Sets all run-time parameters; returns what the node made of those of the method.
  StereoOptions setOptions(const StereoOptions& options, double min_confidence = 0) {
    auto config = cbmv_stereo::StereoConfig::__getDefault__();
    writeConfig(options, config);
    config.min_confidence = min_confidence;
    dynamic_reconfigure::Reconfigure call;
    config.__toMessage__(call.request.config);
    if (!ros::service::waitForService(nh_.resolveName("cbmv_stereo/set_parameters"), 10000) ||
        !ros::service::call(nh_.resolveName("cbmv_stereo/set_parameters"), call)) {
      throw std::runtime_error("the parameters could not be set");
    }
    config.__fromMessage__(call.response.config);
    StereoOptions set = options;
    applyConfig(config, set);
    return set;
  }

  /// Waits for a warning or error that holds all of `words`.
  bool waitForWarning(const std::vector<std::string>& words) {
    return waitFor([&] {
      for (const auto& entry : log_entries_) {
        const bool all = std::all_of(words.begin(), words.end(), [&](const std::string& word) {
          return entry.msg.find(word) != std::string::npos;
        });
        if (all && entry.level >= rosgraph_msgs::Log::WARN) {
          return true;
        }
      }
      return false;
    });
  }

  Collector<stereo_msgs::DisparityImage> disparity;
  Collector<sensor_msgs::PointCloud2> points;
  Collector<sensor_msgs::Image> depth;
  Collector<sensor_msgs::Image> depth_raw;
  Collector<sensor_msgs::CameraInfo> camera_info;
  Collector<sensor_msgs::Image> confidence;
  Collector<sensor_msgs::Image> valid_mask;
  Collector<sensor_msgs::Image> disparity_color;
  Collector<cbmv_stereo::Status> status;

 private:
  ros::NodeHandle nh_;
  ros::Publisher left_image_;
  ros::Publisher left_info_;
  ros::Publisher right_image_;
  ros::Publisher right_info_;
  ros::Publisher color_;
  ros::Subscriber log_;
  std::vector<rosgraph_msgs::Log> log_entries_;
};

}  // namespace cbmv
