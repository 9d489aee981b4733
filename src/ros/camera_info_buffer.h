#pragma once

#include <cstddef>
#include <deque>
#include <optional>

#include <ros/time.h>
#include <sensor_msgs/CameraInfo.h>

namespace cbmv {

/// The camera_infos of one topic. Most drivers send one per image, with the image's stamp. Others
/// send one for all images (latched) or only occasionally. The buffer finds out which: after
/// kStreak consecutive images without a camera_info of their own, images no longer wait for it.
/// After kStreak consecutive images with one (even a late one), they wait again. Not thread-safe.
class CameraInfoBuffer {
 public:
  static constexpr int kStreak = 3;
  static constexpr std::size_t kCapacity = 100;

  void add(const sensor_msgs::CameraInfoConstPtr& info);

  /// Whether an image with this stamp must wait: its camera_info may still arrive, or none has
  /// arrived at all.
  bool isExpected(const ros::Time& stamp) const;

  /// The camera_info with this stamp, else the last one received; null if there is none.
  sensor_msgs::CameraInfoConstPtr find(const ros::Time& stamp) const;

  /// Reports that an image with this stamp was passed on with the result of find().
  void imageHandedOver(const ros::Time& stamp);

  /// Assumes one camera_info per image again.
  void learnAnew();

 private:
  /// Null if there is none.
  sensor_msgs::CameraInfoConstPtr withStamp(const ros::Time& stamp) const;
  void count(bool got_its_own);

  std::deque<sensor_msgs::CameraInfoConstPtr> infos_;  ///< in order of arrival
  std::optional<ros::Time> last_image_;                ///< last image that was passed on
  bool last_got_its_own_ = false;
  int streak_ = 0;  ///< positive: consecutive images with their own camera_info; negative: without
  bool comes_with_images_ = true;
};

}  // namespace cbmv
