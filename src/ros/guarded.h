#pragma once

#include <exception>
#include <string>

#include <nodelet/detail/callback_queue.h>
#include <ros/console.h>

namespace cbmv {

/// Calls `callback` for the nodelet `name` and logs its exceptions. An exception that leaves a
/// callback would end the process with all its nodelets.
template <typename Callback>
void guarded(const std::string& name, const Callback& callback) {
  try {
    callback();
  } catch (const std::exception& error) {
    ROS_ERROR_NAMED(name, "%s: %s", name.c_str(), error.what());
  }
}

/// Lets a nodelet's callbacks run before its onInit() has returned, as nodelet 1.10.1 and later do.
/// nodelet 1.10.0 (Debian 11) discards callbacks until then. Without this, callers of a service
/// would wait forever, and subscribers that connect would not be noticed.
inline void acceptCallbacks(ros::CallbackQueueInterface& queue) {
  if (auto* of_loader = dynamic_cast<nodelet::detail::CallbackQueue*>(&queue)) {
    of_loader->enable();
  }
}

/// Runs `initialize` of the nodelet `name`. If it throws, logs the error as fatal, runs `stop` and
/// rethrows. `stop` is needed because nodelet::Loader frees the callback queues before a nodelet
/// that threw.
template <typename Initialize, typename Stop>
void startNodelet(const std::string& name, const Initialize& initialize, const Stop& stop) {
  try {
    initialize();
  } catch (const std::exception& error) {
    ROS_FATAL_NAMED(name, "cannot start: %s", error.what());
    stop();
    throw;
  }
}

}  // namespace cbmv
