#pragma once

#include <cstddef>
#include <deque>
#include <optional>

#include <ros/time.h>
#include <sensor_msgs/CameraInfo.h>

namespace cbmv {

/// The camera_infos of one topic. Most drivers send one with every image, with its stamp; others
/// one for all images (latched) or seldom. Which kind the topic is of shows when it is used: if
/// kStreak images in a row did not get one of their own, images need not wait for it any more, and
/// if kStreak images in a row got one (be it late), they do again. Not for several threads at a
/// time.
class CameraInfoBuffer {
 public:
  static constexpr int kStreak = 3;
  static constexpr std::size_t kCapacity = 100;

  void add(const sensor_msgs::CameraInfoConstPtr& info);

  /// Whether an image with that stamp has to wait: the one with its stamp may still come, or none
  /// has come at all.
  bool isExpected(const ros::Time& stamp) const;

  /// The one with that stamp, else the newest in order of arrival; null if none has come.
  sensor_msgs::CameraInfoConstPtr find(const ros::Time& stamp) const;

  /// An image with that stamp has been handed over with what find() gave.
  void imageHandedOver(const ros::Time& stamp);

  /// Takes the topic for one with a camera_info for every image again.
  void learnAnew();

 private:
  /// Null if there is none.
  sensor_msgs::CameraInfoConstPtr withStamp(const ros::Time& stamp) const;
  void count(bool got_its_own);

  std::deque<sensor_msgs::CameraInfoConstPtr> infos_;  ///< in order of arrival
  std::optional<ros::Time> last_image_;                ///< that was handed over
  bool last_got_its_own_ = false;
  int streak_ = 0;  ///< images in a row that got their own; negative: that did not
  bool comes_with_images_ = true;
};

}  // namespace cbmv
