#pragma once

#include <array>
#include <atomic>
#include <functional>
#include <mutex>
#include <sstream>
#include <string>
#include <utility>

#include <image_transport/image_transport.h>
#include <image_transport/subscriber_filter.h>
#include <message_filters/subscriber.h>
#include <ros/ros.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/Image.h>
#include <stereo_msgs/DisparityImage.h>

#include "ros/private_parameters.h"
#include "ros/stamp_pairing.h"
#include "ros/sync_monitor.h"

namespace cbmv {

inline SyncOptions readSyncOptions(const PrivateParameters& parameters) {
  return {parameters.get<int>("queue_size"), parameters.get<bool>("approximate_sync"),
          parameters.get<double>("approximate_sync_max_interval_s")};
}

/// An input whose messages can be filtered: images come by an image transport.
template <typename Message>
class InputTopic : public message_filters::Subscriber<Message> {
 public:
  void open(ros::NodeHandle& nh, image_transport::ImageTransport&, const std::string& topic,
            std::uint32_t queue_size, const image_transport::TransportHints&) {
    this->subscribe(nh, topic, queue_size);
  }
  std::uint32_t publishers() const { return this->getSubscriber().getNumPublishers(); }
};

template <>
class InputTopic<sensor_msgs::Image> : public image_transport::SubscriberFilter {
 public:
  void open(ros::NodeHandle&, image_transport::ImageTransport& transport, const std::string& topic,
            std::uint32_t queue_size, const image_transport::TransportHints& hints) {
    subscribe(transport, topic, queue_size, hints);
  }
  std::uint32_t publishers() const { return getNumPublishers(); }
};

/// Four input topics, whose messages are handed over in sets of equal (or close) stamps.
template <typename M0, typename M1, typename M2, typename M3>
class SynchronizedInputs {
 public:
  static constexpr std::size_t kTopics = 4;
  using Topics = std::array<const char*, kTopics>;
  using Callback =
      std::function<void(const boost::shared_ptr<const M0>&, const boost::shared_ptr<const M1>&,
                         const boost::shared_ptr<const M2>&, const boost::shared_ptr<const M3>&)>;

  SynchronizedInputs(const ros::NodeHandle& nh, const PrivateParameters& parameters, Topics topics,
                     Callback callback)
      : nh_(nh),
        transport_(nh),
        hints_("raw", ros::TransportHints(), parameters.nodeHandle()),
        topics_(topics),
        options_(readSyncOptions(parameters)),
        callback_(std::move(callback)),
        monitor_(kTopics, remedy()),
        pairing_(options_, [this](const auto&... messages) { receive(messages...); }) {
    connect<0>(first_);
    connect<1>(second_);
    connect<2>(third_);
    connect<3>(fourth_);
  }

  const SyncOptions& options() const { return options_; }
  const image_transport::TransportHints& hints() const { return hints_; }
  bool isSubscribed() const { return subscribed_; }

  /// Throws image_transport::Exception if there is no such transport; then nothing is subscribed.
  void subscribe() {
    const auto queue = static_cast<std::uint32_t>(options_.queue_size);
    first_.open(nh_, transport_, topics_[0], queue, hints_);
    second_.open(nh_, transport_, topics_[1], queue, hints_);
    third_.open(nh_, transport_, topics_[2], queue, hints_);
    fourth_.open(nh_, transport_, topics_[3], queue, hints_);
    monitor_.restart(ros::SteadyTime::now());
    subscribed_ = true;
  }

  void unsubscribe() {
    first_.unsubscribe();
    second_.unsubscribe();
    third_.unsubscribe();
    fourth_.unsubscribe();
    subscribed_ = false;
  }

  /// Types of the messages, such as sensor_msgs/Image.
  static std::array<std::string, kTopics> types() {
    namespace traits = ros::message_traits;
    return {traits::datatype<M0>(), traits::datatype<M1>(), traits::datatype<M2>(),
            traits::datatype<M3>()};
  }

  /// Resolved, in the order of the messages.
  std::array<std::string, kTopics> topics() const {
    std::array<std::string, kTopics> names;
    for (std::size_t i = 0; i < kTopics; ++i) {
      names[i] = nh_.resolveName(topics_[i]);
    }
    return names;
  }

  /// What has been wrong with stamps since the last call (SyncMonitor); else empty.
  std::string reportStamps() {
    const auto names = topics();
    return monitor_.reportStamps({names.begin(), names.end()});
  }

  /// A report to people if messages are waited for and none are paired (SyncMonitor); else empty.
  std::string reportSilence() {
    if (!subscribed_) {
      return {};
    }
    const auto names = topics();
    return monitor_.report(ros::SteadyTime::now(), {{names[0], first_.publishers() > 0},
                                                    {names[1], second_.publishers() > 0},
                                                    {names[2], third_.publishers() > 0},
                                                    {names[3], fourth_.publishers() > 0}});
  }

 private:
  template <int kIndex, typename Message>
  void connect(InputTopic<Message>& input) {
    input.registerCallback([this](const boost::shared_ptr<const Message>& message) {
      const std::lock_guard<std::mutex> lock(pairing_mutex_);
      try {
        const ros::Time& stamp = message->header.stamp;
        if (monitor_.received(kIndex, stamp)) {
          pairing_.dropAfter(SyncMonitor::latestWith(stamp));
        }
        pairing_.template add<kIndex>(message);
      } catch (const std::exception& error) {
        ROS_WARN_STREAM_THROTTLE(
            5, topics()[kIndex] << ": a message could not be paired: " << error.what());
        pairing_.clear();
      }
    });
  }

  void receive(const boost::shared_ptr<const M0>& first, const boost::shared_ptr<const M1>& second,
               const boost::shared_ptr<const M2>& third,
               const boost::shared_ptr<const M3>& fourth) {
    monitor_.synchronized(ros::SteadyTime::now());
    callback_(first, second, third, fourth);
  }

  std::string remedy() const {
    if (!options_.approximate) {
      return "their stamps have to be equal, or set the parameter approximate_sync";
    }
    std::ostringstream words;
    words << "their stamps may be up to approximate_sync_max_interval_s = "
          << options_.max_interval_s << " s apart (0: no bound)";
    return words.str();
  }

  ros::NodeHandle nh_;
  image_transport::ImageTransport transport_;
  const image_transport::TransportHints hints_;
  const Topics topics_;
  const SyncOptions options_;
  Callback callback_;
  SyncMonitor monitor_;
  std::atomic<bool> subscribed_{false};
  std::mutex pairing_mutex_;
  StampPairing<M0, M1, M2, M3> pairing_;

  InputTopic<M0> first_;
  InputTopic<M1> second_;
  InputTopic<M2> third_;
  InputTopic<M3> fourth_;
};

}  // namespace cbmv
