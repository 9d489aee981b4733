#include "ros/sync_monitor.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <utility>

#include "ros/stamps.h"

namespace cbmv {
namespace {

constexpr std::size_t kStampsKept = 32;

std::string text(const char* format, double value) {
  char buffer[64];
  std::snprintf(buffer, sizeof(buffer), format, value);
  return buffer;
}

double gapMs(const ros::Time& a, const ros::Time& b) {
  return std::abs(secondsBetween(a, b)) * 1000;
}

/// Appends to a list of words.
void append(const std::string& words, std::string& list) {
  list += (list.empty() ? "" : ", ") + words;
}

}  // namespace

SyncMonitor::SyncMonitor(std::size_t topics, std::string remedy)
    : remedy_(std::move(remedy)), topics_(topics), stamps_(topics) {}

void SyncMonitor::restart(ros::SteadyTime now) {
  const std::lock_guard<std::mutex> lock(mutex_);
  beginWindow(now, kFirstReportS);
  stamps_.assign(topics_.size(), {});
}

bool SyncMonitor::received(std::size_t topic, const ros::Time& stamp) {
  const std::lock_guard<std::mutex> lock(mutex_);
  Topic& seen = topics_.at(topic);
  ++seen.count;
  seen.stamps.push_back(stamp);
  if (seen.stamps.size() > kStampsKept) {
    seen.stamps.pop_front();
  }
  return compare(stamp, stamps_.at(topic));
}

ros::Time SyncMonitor::latestWith(const ros::Time& stamp) {
  constexpr auto kJumpNs = static_cast<std::uint64_t>(kJumpS * 1e9);
  ros::Time latest;
  latest.fromNSec(std::min(stamp.toNSec(), ros::TIME_MAX.toNSec() - kJumpNs) + kJumpNs);
  return latest;
}

/// Notes what is to be reported; returns what received() does.
bool SyncMonitor::compare(const ros::Time& stamp, Stamps& stamps) {
  const auto before = std::exchange(stamps.newest, stamp);
  if (!before || stamp > *before) {
    return false;
  }
  if (stamp == *before) {
    ++stamps.repeated;
    return false;
  }
  const double step_back_s = secondsBetween(stamp, *before);
  stamps.largest_step_back_s = std::max(stamps.largest_step_back_s, step_back_s);
  return step_back_s > kJumpS;
}

std::string SyncMonitor::reportStamps(const std::vector<std::string>& names) {
  const std::lock_guard<std::mutex> lock(mutex_);
  std::string back;
  std::string repeated;
  for (std::size_t i = 0; i < stamps_.size(); ++i) {
    Stamps& stamps = stamps_[i];
    if (stamps.largest_step_back_s > 0) {
      append(names.at(i) + text(" (%.3f s)", stamps.largest_step_back_s), back);
    }
    if (stamps.repeated > 0) {
      append(names.at(i) + text(" (%.0f times)", stamps.repeated), repeated);
    }
    stamps.largest_step_back_s = 0;
    stamps.repeated = 0;
  }
  std::string sentence;
  if (!back.empty()) {
    append("stamps went back on " + back, sentence);
  }
  if (!repeated.empty()) {
    append("stamps came twice on " + repeated, sentence);
  }
  return sentence;
}

void SyncMonitor::synchronized(ros::SteadyTime now) {
  const std::lock_guard<std::mutex> lock(mutex_);
  beginWindow(now, patience_s_);
}

std::string SyncMonitor::report(ros::SteadyTime now, const std::vector<TopicState>& states) {
  const std::lock_guard<std::mutex> lock(mutex_);
  const double elapsed_s = (now - window_start_).toSec();
  if (elapsed_s < patience_s_) {
    return {};
  }
  std::string sentence = describe(states, elapsed_s);
  beginWindow(now, kNextReportS);
  return sentence;
}

void SyncMonitor::beginWindow(ros::SteadyTime now, double patience_s) {
  for (Topic& topic : topics_) {
    topic = {};
  }
  window_start_ = now;
  patience_s_ = patience_s;
}

std::string SyncMonitor::describe(const std::vector<TopicState>& states, double elapsed_s) const {
  std::string sentence = "no synchronised set of messages in " + text("%.0f", elapsed_s) + " s:";
  for (std::size_t i = 0; i < topics_.size(); ++i) {
    sentence += (i > 0 ? ", " : " ") + describeTopic(i, states.at(i), elapsed_s);
  }
  return allArrive() ? sentence + "; " + remedy_ : sentence;
}

std::string SyncMonitor::describeTopic(std::size_t index, const TopicState& state,
                                       double elapsed_s) const {
  const Topic& topic = topics_[index];
  if (topic.count == 0) {
    return state.name + (state.has_publisher ? " nothing (it has a publisher)"
                                             : " nothing (nobody publishes it)");
  }
  std::string words = state.name + text(" %.1f Hz", static_cast<double>(topic.count) / elapsed_s);
  if (index > 0 && topics_[0].count > 0) {
    words += text(" (stamps %.1f ms from the first topic's)", typicalGapMs(index));
  }
  return words;
}

/// Median distance of the topic's stamps to the nearest of the first topic.
double SyncMonitor::typicalGapMs(std::size_t topic) const {
  std::vector<double> gaps;
  for (const ros::Time& stamp : topics_[topic].stamps) {
    double nearest = std::numeric_limits<double>::infinity();
    for (const ros::Time& other : topics_[0].stamps) {
      nearest = std::min(nearest, gapMs(stamp, other));
    }
    gaps.push_back(nearest);
  }
  const auto middle = gaps.begin() + static_cast<std::ptrdiff_t>(gaps.size() / 2);
  std::nth_element(gaps.begin(), middle, gaps.end());
  return *middle;
}

bool SyncMonitor::allArrive() const {
  return std::all_of(topics_.begin(), topics_.end(),
                     [](const Topic& topic) { return topic.count > 0; });
}

}  // namespace cbmv
