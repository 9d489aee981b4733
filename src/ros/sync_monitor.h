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

/// The inputs of a nodelet: two topics whose messages are paired, and the camera_info of either.
enum InputIndex : std::size_t { kFirst, kFirstInfo, kSecond, kSecondInfo, kInputs };

/// Watches the inputs, and tells people why nothing comes of them. Callable from several threads.
/// Needs no master.
class SyncMonitor {
 public:
  explicit SyncMonitor(const SyncOptions& options) : options_(options) {}

  /// Begins to wait for a set: what came before does not count.
  void restart(ros::SteadyTime now);
  void received(std::size_t input, const ros::Time& stamp);
  void synchronized(ros::SteadyTime now);

  /// What is said about a topic besides its messages.
  struct TopicState {
    std::string name;  ///< resolved
    bool has_publisher = false;
  };
  using TopicStates = std::array<TopicState, kInputs>;

  /// A report if no set has come for kFirstReportS, and from the first report on for kNextReportS
  /// (slow cameras are not reported all the time); else empty. Says of each topic at what rate
  /// messages come, whether anybody publishes it, how far the stamps of the second topic are from
  /// those of the first, and what to do.
  std::string report(ros::SteadyTime now, const TopicStates& states);

  /// What was wrong with stamps since the last call: topics on which they went back or came twice,
  /// of those that are paired; else empty.
  std::string reportStamps(const std::array<std::string, kInputs>& names);

  static constexpr double kFirstReportS = 4;
  static constexpr double kNextReportS = 30;

 private:
  /// Messages of the time that a report is about.
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
