#pragma once

#include <functional>

#include <ros/callback_queue.h>
#include <ros/ros.h>

namespace cbmv {

/// Processes callbacks until `done` is true or the timeout has passed; returns whether it is done.
inline bool waitFor(const std::function<bool()>& done, double timeout_s = 30) {
  const ros::WallTime end = ros::WallTime::now() + ros::WallDuration(timeout_s);
  while (ros::ok() && !done() && ros::WallTime::now() < end) {
    ros::getGlobalCallbackQueue()->callAvailable(ros::WallDuration(0.01));
  }
  return done();
}

inline void wait(double time_s) {
  waitFor([] { return false; }, time_s);
}

}  // namespace cbmv
