#pragma once

#include <cstddef>
#include <deque>
#include <mutex>

#include <sensor_msgs/Image.h>

namespace cbmv {

/// The newest colour images, found by their stamp.
class ColorBuffer {
 public:
  explicit ColorBuffer(std::size_t capacity) : capacity_(capacity) {}

  void add(const sensor_msgs::ImageConstPtr& image) {
    const std::lock_guard<std::mutex> lock(mutex_);
    images_.push_back(image);
    if (images_.size() > capacity_) {
      images_.pop_front();
    }
  }

  /// Null if no image has that stamp.
  sensor_msgs::ImageConstPtr find(const ros::Time& stamp) const {
    const std::lock_guard<std::mutex> lock(mutex_);
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
  std::deque<sensor_msgs::ImageConstPtr> images_;
};

}  // namespace cbmv
