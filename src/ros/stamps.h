#pragma once

#include <cstdint>

#include <ros/time.h>

namespace cbmv {

/// From `earlier` to `later`, for any stamps: ros::Time's own difference throws beyond 68 years,
/// which stamps that a driver has not set exceed.
inline std::int64_t nanosecondsBetween(const ros::Time& earlier, const ros::Time& later) {
  return static_cast<std::int64_t>(later.toNSec()) - static_cast<std::int64_t>(earlier.toNSec());
}

/// The same in seconds.
inline double secondsBetween(const ros::Time& earlier, const ros::Time& later) {
  return static_cast<double>(nanosecondsBetween(earlier, later)) / 1e9;
}

}  // namespace cbmv
