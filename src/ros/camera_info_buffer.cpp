#include "ros/camera_info_buffer.h"

#include <algorithm>
#include <cstdlib>

namespace cbmv {

void CameraInfoBuffer::add(const sensor_msgs::CameraInfoConstPtr& info) {
  infos_.push_back(info);
  if (infos_.size() > kCapacity) {
    infos_.pop_front();
  }
  if (last_image_ == info->header.stamp) {
    last_got_its_own_ = true;
  }
}

bool CameraInfoBuffer::isExpected(const ros::Time& stamp) const {
  return infos_.empty() || (comes_with_images_ && !withStamp(stamp));
}

sensor_msgs::CameraInfoConstPtr CameraInfoBuffer::find(const ros::Time& stamp) const {
  const auto own = withStamp(stamp);
  return own || infos_.empty() ? own : infos_.back();
}

void CameraInfoBuffer::imageHandedOver(const ros::Time& stamp) {
  if (last_image_) {
    count(last_got_its_own_);  // not earlier, because its camera_info may arrive late
  }
  last_image_ = stamp;
  last_got_its_own_ = withStamp(stamp) != nullptr;
}

void CameraInfoBuffer::learnAnew() {
  last_image_.reset();
  streak_ = 0;
  comes_with_images_ = true;
}

sensor_msgs::CameraInfoConstPtr CameraInfoBuffer::withStamp(const ros::Time& stamp) const {
  const auto found = std::find_if(infos_.rbegin(), infos_.rend(),
                                  [&](const auto& info) { return info->header.stamp == stamp; });
  return found == infos_.rend() ? nullptr : *found;
}

void CameraInfoBuffer::count(bool got_its_own) {
  streak_ = got_its_own ? std::max(streak_, 0) + 1 : std::min(streak_, 0) - 1;
  if (std::abs(streak_) >= kStreak) {
    comes_with_images_ = got_its_own;
  }
}

}  // namespace cbmv
