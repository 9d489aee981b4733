#pragma once

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <deque>
#include <mutex>

#include <sensor_msgs/Image.h>

namespace cbmv {

/// The newest color images, found by their stamp. Thread-safe.
class ColorBuffer {
 public:
  explicit ColorBuffer(std::size_t capacity) : capacity_(capacity) {}

  void add(const sensor_msgs::ImageConstPtr& image) {
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      if (!images_.empty() && image->header.stamp < images_.back()->header.stamp) {
        images_.clear();  // time went back: nothing waits for the later stamps
      }
      images_.push_back(image);
      if (images_.size() > capacity_) {
        images_.pop_front();
      }
    }
    added_.notify_all();
  }

  void clear() {
    const std::lock_guard<std::mutex> lock(mutex_);
    images_.clear();
  }

  /// Null if no image has this stamp. Waits up to `patience` while no image with this or a later
  /// stamp has arrived.
  sensor_msgs::ImageConstPtr find(const ros::Time& stamp,
                                  std::chrono::milliseconds patience) const {
    std::unique_lock<std::mutex> lock(mutex_);
    added_.wait_for(lock, patience, [&] {
      return std::any_of(images_.begin(), images_.end(),
                         [&](const auto& image) { return image->header.stamp >= stamp; });
    });
    for (const auto& image : images_) {
      if (image->header.stamp == stamp) {
        return image;
      }
    }
    return nullptr;
  }

 private:
  const std::size_t capacity_;
  mutable std::mutex mutex_;
  mutable std::condition_variable added_;
  std::deque<sensor_msgs::ImageConstPtr> images_;
};

}  // namespace cbmv
