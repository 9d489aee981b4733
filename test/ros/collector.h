#pragma once

#include <map>
#include <string>

#include <ros/ros.h>

namespace cbmv {

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
  const Message& newest() const { return *messages_.rbegin()->second; }
  template <typename Use>
  void forEach(const Use& use) const {
    for (const auto& [stamp, message] : messages_) {
      use(*message);
    }
  }
  void forget(ros::Time stamp) { messages_.erase(stamp); }
  std::size_t count() const { return messages_.size(); }

 private:
  ros::Subscriber subscriber_;
  std::map<ros::Time, boost::shared_ptr<const Message>> messages_;
};

}  // namespace cbmv
