#pragma once

#include <map>
#include <mutex>

#include <ros/time.h>

namespace cbmv {

/// Limits warnings to one per cause and period. The caller chooses the cause numbers.
class WarningThrottle {
 public:
  explicit WarningThrottle(double period_s) : period_s_(period_s) {}

  /// Whether a warning of this cause may be logged now. If so, the period starts again.
  bool isDue(int cause) {
    const std::lock_guard<std::mutex> lock(mutex_);
    const ros::SteadyTime now = ros::SteadyTime::now();
    const auto last = last_.find(cause);
    if (last != last_.end() && (now - last->second).toSec() < period_s_) {
      return false;
    }
    last_[cause] = now;
    return true;
  }

 private:
  const double period_s_;
  std::mutex mutex_;
  std::map<int, ros::SteadyTime> last_;
};

}  // namespace cbmv
