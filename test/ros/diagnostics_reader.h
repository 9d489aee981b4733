#pragma once

#include <functional>
#include <map>
#include <string>

#include <diagnostic_msgs/DiagnosticArray.h>
#include <ros/ros.h>

#include "ros/wait_for.h"

namespace cbmv {

/// The newest diagnostics of a node.
class DiagnosticsReader {
 public:
  /// `node` without the leading slash.
  explicit DiagnosticsReader(const std::string& node) : prefix_(node + ": ") {
    subscriber_ = nh_.subscribe<diagnostic_msgs::DiagnosticArray>(
        "/diagnostics", 100, [this](const diagnostic_msgs::DiagnosticArrayConstPtr& array) {
          for (const auto& status : array->status) {
            newest_[status.name] = status;
          }
        });
  }

  /// Waits for a level and for text in the message or in one of the values.
  bool waitFor(
      const std::string& name, int level, const std::string& words,
      const std::function<void()>& meanwhile = [] {}) {
    return cbmv::waitFor([&] {
      meanwhile();
      wait(0.1);
      const auto found = newest_.find(prefix_ + name);
      return found != newest_.end() && found->second.level == level && holds(found->second, words);
    });
  }

  /// Discards received diagnostics, so that the next ones describe the current state.
  void clear() { newest_.clear(); }

  /// Empty if the value does not exist.
  std::string newestValue(const std::string& name, const std::string& key) const {
    const auto found = newest_.find(prefix_ + name);
    if (found != newest_.end()) {
      for (const auto& entry : found->second.values) {
        if (entry.key == key) {
          return entry.value;
        }
      }
    }
    return {};
  }

  std::string newestMessage(const std::string& name) const {
    const auto found = newest_.find(prefix_ + name);
    return found == newest_.end() ? "none came" : found->second.message;
  }

 private:
  static bool holds(const diagnostic_msgs::DiagnosticStatus& status, const std::string& words) {
    bool found = status.message.find(words) != std::string::npos;
    for (const auto& entry : status.values) {
      found = found || entry.value.find(words) != std::string::npos;
    }
    return found;
  }

  std::string prefix_;
  ros::NodeHandle nh_;
  ros::Subscriber subscriber_;
  std::map<std::string, diagnostic_msgs::DiagnosticStatus> newest_;
};

}  // namespace cbmv
