#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include <ros/ros.h>
#include <rosgraph_msgs/Log.h>

#include "ros/wait_for.h"

namespace cbmv {

/// Reads the log of all nodes.
class LogReader {
 public:
  LogReader() {
    subscriber_ = nh_.subscribe<rosgraph_msgs::Log>(
        "/rosout", 1000, [this](const boost::shared_ptr<const rosgraph_msgs::Log>& entry) {
          entries_.push_back(*entry);
        });
  }

  /// Waits for a warning or error that contains all of `words`.
  bool waitForWarning(const std::vector<std::string>& words, double timeout_s = 30) {
    return waitFor([&] { return hasWarning(words); }, timeout_s);
  }

 private:
  bool hasWarning(const std::vector<std::string>& words) const {
    return std::any_of(entries_.begin(), entries_.end(), [&](const rosgraph_msgs::Log& entry) {
      return entry.level >= rosgraph_msgs::Log::WARN &&
             std::all_of(words.begin(), words.end(), [&](const std::string& word) {
               return entry.msg.find(word) != std::string::npos;
             });
    });
  }

  ros::NodeHandle nh_;
  ros::Subscriber subscriber_;
  std::vector<rosgraph_msgs::Log> entries_;
};

}  // namespace cbmv
