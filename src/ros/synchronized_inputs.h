#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <mutex>
#include <string>
#include <utility>

#include <image_transport/image_transport.h>
#include <image_transport/subscriber_filter.h>
#include <message_filters/subscriber.h>
#include <ros/ros.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/Image.h>
#include <stereo_msgs/DisparityImage.h>

#include "ros/calibrated_pairs.h"
#include "ros/guarded.h"
#include "ros/input_topics.h"
#include "ros/private_parameters.h"
#include "ros/stamp_pairing.h"
#include "ros/sync_monitor.h"

namespace cbmv {

inline SyncOptions readSyncOptions(const PrivateParameters& parameters) {
  return {parameters.get<int>("queue_size"), parameters.get<bool>("approximate_sync"),
          parameters.get<double>("approximate_sync_max_interval_s")};
}

/// An input for message filters; images use an image transport.
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

/// Two input topics with their camera_infos. Pairs messages by equal (or close) stamps and passes
/// them on with their camera_infos (StampPairing, CalibratedPairs).
template <typename First, typename Second>
class SynchronizedInputs {
 public:
  using Pairs = CalibratedPairs<First, Second>;
  using Callback = typename Pairs::Callback;

  /// `names`: as in the code or as configured; they are resolved and remapped. Throws Error if two
  /// of them are the same topic.
  SynchronizedInputs(const ros::NodeHandle& nh, const PrivateParameters& parameters,
                     TopicNames names, Callback callback)
      : nh_(nh),
        transport_(nh),
        hints_("raw", ros::TransportHints(), parameters.nodeHandle()),
        names_(std::move(names)),
        options_(readSyncOptions(parameters)),
        callback_(std::move(callback)),
        monitor_(options_),
        pairs_([this](const auto&... messages) { this->receive(messages...); }),
        pairing_(options_, [this](const auto& first, const auto& second) {
          pairs_.addPair(first, second, ros::SteadyTime::now());
        }) {
    requireDifferentTopics(topics());
    connect<kFirst>(first_, [this](const auto& message) { pairing_.template add<0>(message); });
    connect<kFirstInfo>(first_info_, [this](const auto& info) { pairs_.addInfo(0, info); });
    connect<kSecond>(second_, [this](const auto& message) { pairing_.template add<1>(message); });
    connect<kSecondInfo>(second_info_, [this](const auto& info) { pairs_.addInfo(1, info); });
  }

  const SyncOptions& options() const { return options_; }
  const image_transport::TransportHints& hints() const { return hints_; }
  bool isSubscribed() const { return subscribed_; }

  /// Throws image_transport::Exception if the transport does not exist; then nothing is subscribed.
  void subscribe() {
    {
      const std::lock_guard<std::mutex> lock(pairing_mutex_);
      pairing_.clear();
      pairs_.clear();
    }
    open<kFirst>(first_);
    open<kFirstInfo>(first_info_);
    open<kSecond>(second_);
    open<kSecondInfo>(second_info_);
    monitor_.restart(ros::SteadyTime::now());
    subscribed_ = true;
  }

  void unsubscribe() {
    first_.unsubscribe();
    first_info_.unsubscribe();
    second_.unsubscribe();
    second_info_.unsubscribe();
    subscribed_ = false;
  }

  /// Message types, for example sensor_msgs/Image.
  static TopicNames types() {
    namespace traits = ros::message_traits;
    return {traits::datatype<First>(), traits::datatype<sensor_msgs::CameraInfo>(),
            traits::datatype<Second>(), traits::datatype<sensor_msgs::CameraInfo>()};
  }

  /// Resolved topic names.
  TopicNames topics() const {
    TopicNames resolved;
    std::transform(names_.begin(), names_.end(), resolved.begin(),
                   [this](const std::string& name) { return nh_.resolveName(name); });
    return resolved;
  }

  /// Call regularly: passes on pairs that have waited too long for their camera_infos.
  void handOverIfOverdue() {
    const std::lock_guard<std::mutex> lock(pairing_mutex_);
    pairs_.handOverIfOverdue(ros::SteadyTime::now());
  }

  /// Stamp errors since the last call (SyncMonitor); else empty.
  std::string reportStamps() { return monitor_.reportStamps(topics()); }

  /// A report if the inputs are subscribed and no pairs arrive (SyncMonitor); else empty.
  std::string reportSilence() {
    if (!subscribed_) {
      return {};
    }
    const TopicNames names = topics();
    return monitor_.report(ros::SteadyTime::now(),
                           {{{names[kFirst], first_.publishers() > 0},
                             {names[kFirstInfo], first_info_.publishers() > 0},
                             {names[kSecond], second_.publishers() > 0},
                             {names[kSecondInfo], second_info_.publishers() > 0}}});
  }

 private:
  template <InputIndex kIndex, typename Message, typename Add>
  void connect(InputTopic<Message>& input, Add add) {
    input.registerCallback([this, add](const boost::shared_ptr<const Message>& message) {
      const std::lock_guard<std::mutex> lock(pairing_mutex_);
      monitor_.received(kIndex, message->header.stamp);
      guarded(names_[kIndex], [&] { add(message); });
    });
  }

  template <InputIndex kIndex, typename Message>
  void open(InputTopic<Message>& input) {
    input.open(nh_, transport_, nameToSubscribe(nh_, names_[kIndex]),
               static_cast<std::uint32_t>(options_.queue_size), hints_);
  }

  template <typename... Messages>
  void receive(const Messages&... messages) {
    monitor_.synchronized(ros::SteadyTime::now());
    callback_(messages...);
  }

  ros::NodeHandle nh_;
  image_transport::ImageTransport transport_;
  const image_transport::TransportHints hints_;
  const TopicNames names_;
  const SyncOptions options_;
  Callback callback_;
  SyncMonitor monitor_;
  std::atomic<bool> subscribed_{false};
  std::mutex pairing_mutex_;  ///< protects the next two members
  Pairs pairs_;
  StampPairing<First, Second> pairing_;

  InputTopic<First> first_;
  InputTopic<sensor_msgs::CameraInfo> first_info_;
  InputTopic<Second> second_;
  InputTopic<sensor_msgs::CameraInfo> second_info_;
};

}  // namespace cbmv
