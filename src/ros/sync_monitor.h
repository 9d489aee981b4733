#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <string>

#include <ros/time.h>

#include "ros/stamp_pairing.h"
#include "ros/sync_advice.h"

namespace cbmv {

/// Inputs of a nodelet: two topics whose messages are paired, and the camera_info of each.
enum InputIndex : std::size_t { kFirst, kFirstInfo, kSecond, kSecondInfo, kInputs };

/// Monitors the inputs and reports why no pairs arrive. Thread-safe. Needs no ROS master.
class SyncMonitor {
 public:
  explicit SyncMonitor(const SyncOptions& options) : options_(options) {}

  /// Starts waiting for a set; discards earlier observations.
  void restart(ros::SteadyTime now);
  void received(std::size_t input, const ros::Time& stamp);
  void synchronized(ros::SteadyTime now);

  /// State of a topic besides its messages.
  struct TopicState {
    std::string name;  ///< resolved
    bool has_publisher = false;
  };
  using TopicStates = std::array<TopicState, kInputs>;

  /// Returns a report if no set has arrived for kFirstReportS; after the first report, for
  /// kNextReportS, so that slow cameras are not reported repeatedly. Else empty. The report has,
  /// per topic, the message rate and whether there is a publisher, then the distance between the
  /// stamps of both topics and what to do.
  std::string report(ros::SteadyTime now, const TopicStates& states);

  /// Stamp errors since the last call: paired topics whose stamps went back or were repeated; else
  /// empty.
  std::string reportStamps(const std::array<std::string, kInputs>& names);

  static constexpr double kFirstReportS = 4;
  static constexpr double kNextReportS = 30;

 private:
  /// Messages in the time span of a report.
  struct Topic {
    std::uint64_t count = 0;
    std::deque<ros::Time> stamps;  ///< the newest
  };

  /// Stamps of a topic since it was subscribed.
  struct Stamps {
    std::optional<ros::Time> newest;
    double largest_step_back_s = 0;  ///< not reported yet
    int repeated = 0;                ///< not reported yet
  };

  static void compare(const ros::Time& stamp, Stamps& stamps);
  void beginWindow(ros::SteadyTime now, double patience_s);
  std::string describe(const TopicStates& states, double elapsed_s) const;
  std::string describeTopic(std::size_t input, const TopicState& state, double elapsed_s) const;
  std::string advice(const TopicStates& states, double elapsed_s) const;
  StampRelation relation(double elapsed_s) const;
  double typicalDistanceS() const;
  int lag() const;
  bool bothArrive() const { return topics_[kFirst].count > 0 && topics_[kSecond].count > 0; }

  const SyncOptions options_;
  mutable std::mutex mutex_;
  std::array<Topic, kInputs> topics_;
  std::array<Stamps, kInputs> stamps_;
  std::array<bool, kInputs> has_ever_come_{};
  ros::SteadyTime window_start_;
  double patience_s_ = kFirstReportS;
};

}  // namespace cbmv
