#pragma once

#include <exception>
#include <string>

#include <ros/console.h>

namespace cbmv {

/// Runs the `initialize` of the nodelet called `name`. If it throws, logs why as fatal, runs `stop`
/// and throws on: nodelet::Loader frees the callback queues before it frees a nodelet that threw.
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
