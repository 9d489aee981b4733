#pragma once

#include <exception>
#include <string>

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

}  // namespace cbmv
