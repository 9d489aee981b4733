#pragma once

#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include <ros/time.h>

namespace cbmv {

/// Watches topics whose messages have to be paired by their stamps, and tells people why nothing
/// comes of them. Callable from several threads. Needs no master.
class SyncMonitor {
 public:
  /// `remedy` ends a report about stamps that do not fit.
  SyncMonitor(std::size_t topics, std::string remedy);

  /// Begins to wait for a set: what came before does not count.
  void restart(ros::SteadyTime now);
  /// Returns whether time has jumped back: the stamp is older than the one before it on its topic
  /// by more than kJumpS. By less, the messages are out of order.
  bool received(std::size_t topic, const ros::Time& stamp);
  void synchronized(ros::SteadyTime now);

  /// What is said about a topic besides its messages.
  struct TopicState {
    std::string name;  ///< resolved
    bool has_publisher = false;
  };

  /// A report if no set has come for kFirstReportS, and from the first report on for kNextReportS
  /// (slow cameras are not reported all the time); else empty. Says of each topic at what rate
  /// messages come, whether anybody publishes it, and how far its stamps are from those of the
  /// first topic.
  std::string report(ros::SteadyTime now, const std::vector<TopicState>& states);

  /// What was wrong with stamps since the last call: topics (`names`) on which they went back or
  /// came twice; else empty.
  std::string reportStamps(const std::vector<std::string>& names);

  static constexpr double kJumpS = 0.5;
  /// The latest stamp of messages that are of the same time as one with `stamp`.
  static ros::Time latestWith(const ros::Time& stamp);

  static constexpr double kFirstReportS = 4;
  static constexpr double kNextReportS = 30;

 private:
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

  static bool compare(const ros::Time& stamp, Stamps& stamps);
  void beginWindow(ros::SteadyTime now, double patience_s);
  std::string describe(const std::vector<TopicState>& states, double elapsed_s) const;
  std::string describeTopic(std::size_t index, const TopicState& state, double elapsed_s) const;
  double typicalGapMs(std::size_t topic) const;
  bool allArrive() const;

  const std::string remedy_;
  mutable std::mutex mutex_;
  std::vector<Topic> topics_;
  std::vector<Stamps> stamps_;
  ros::SteadyTime window_start_;
  double patience_s_ = kFirstReportS;
};

}  // namespace cbmv
