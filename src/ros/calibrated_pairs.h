#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <optional>
#include <utility>

#include <boost/shared_ptr.hpp>
#include <ros/time.h>
#include <sensor_msgs/CameraInfo.h>

#include "ros/camera_info_buffer.h"

namespace cbmv {

/// Adds camera_info to each message of a pair: the one with the message's stamp, else the newest
/// received on the topic. A pair waits for the camera_infos with its stamps if the topics send one
/// per image (CameraInfoBuffer), at most until the next pair or for kPatienceS seconds. If a topic
/// has not had any camera_info yet, only the newest pair waits. Not thread-safe.
template <typename First, typename Second>
class CalibratedPairs {
 public:
  template <typename Message>
  using Pointer = boost::shared_ptr<const Message>;
  using Info = sensor_msgs::CameraInfoConstPtr;
  using Callback =
      std::function<void(const Pointer<First>&, const Info&, const Pointer<Second>&, const Info&)>;

  static constexpr double kPatienceS = 0.5;

  explicit CalibratedPairs(Callback callback) : callback_(std::move(callback)) {}

  void addPair(const Pointer<First>& first, const Pointer<Second>& second, ros::SteadyTime now) {
    handOver();
    if (newest_stamp_ && first->header.stamp < *newest_stamp_) {
      learnAnew();  // time went back: possibly another camera
    }
    newest_stamp_ = first->header.stamp;
    waiting_ = Waiting{first, second, now};
    handOverIfComplete();
  }

  /// `camera`: 0 for the first message, 1 for the second.
  void addInfo(std::size_t camera, const Info& info) {
    infos_.at(camera).add(info);
    handOverIfComplete();
  }

  void handOverIfOverdue(ros::SteadyTime now) {
    if (waiting_ && (now - waiting_->since).toSec() > kPatienceS) {
      handOver();
    }
  }

  /// Drops the waiting pair. The newest camera_infos remain the fallback.
  void clear() {
    waiting_.reset();
    learnAnew();
  }

 private:
  struct Waiting {
    Pointer<First> first;
    Pointer<Second> second;
    ros::SteadyTime since;
  };

  void learnAnew() {
    for (CameraInfoBuffer& infos : infos_) {
      infos.learnAnew();
    }
  }

  void handOverIfComplete() {
    if (waiting_ && !infos_[0].isExpected(waiting_->first->header.stamp) &&
        !infos_[1].isExpected(waiting_->second->header.stamp)) {
      handOver();
    }
  }

  /// Passes on the waiting pair, if there is one and each camera has had a camera_info.
  void handOver() {
    if (!waiting_) {
      return;
    }
    const ros::Time& first_stamp = waiting_->first->header.stamp;
    const ros::Time& second_stamp = waiting_->second->header.stamp;
    const Info first_info = infos_[0].find(first_stamp);
    const Info second_info = infos_[1].find(second_stamp);
    if (!first_info || !second_info) {
      return;
    }
    infos_[0].imageHandedOver(first_stamp);
    infos_[1].imageHandedOver(second_stamp);
    const Waiting pair = *std::exchange(waiting_, std::nullopt);
    callback_(pair.first, first_info, pair.second, second_info);
  }

  const Callback callback_;
  std::array<CameraInfoBuffer, 2> infos_;
  std::optional<Waiting> waiting_;
  std::optional<ros::Time> newest_stamp_;
};

}  // namespace cbmv
