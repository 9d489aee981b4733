#pragma once

#include <cstdint>

#include <ros/time.h>

namespace cbmv {

/// Time from `earlier` to `later`, for any stamps. The difference operator of ros::Time throws
/// above 68 years, which happens if a driver does not set the stamp.
inline std::int64_t nanosecondsBetween(const ros::Time& earlier, const ros::Time& later) {
  return static_cast<std::int64_t>(later.toNSec()) - static_cast<std::int64_t>(earlier.toNSec());
}

/// The same in seconds.
inline double secondsBetween(const ros::Time& earlier, const ros::Time& later) {
  return static_cast<double>(nanosecondsBetween(earlier, later)) / 1e9;
}

}  // namespace cbmv
