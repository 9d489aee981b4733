#pragma once

#include <ros/time.h>

namespace cbmv {

/// From `earlier` to `later`, for any stamps: ros::Time's own difference throws beyond 68 years,
/// which stamps that a driver has not set exceed.
inline double secondsBetween(const ros::Time& earlier, const ros::Time& later) {
  return (static_cast<double>(later.sec) - earlier.sec) +
         (static_cast<double>(later.nsec) - earlier.nsec) * 1e-9;
}

}  // namespace cbmv
