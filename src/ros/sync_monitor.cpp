#include "ros/sync_monitor.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <utility>
#include <vector>

#include "ros/stamps.h"

namespace cbmv {
namespace {

constexpr std::size_t kStampsKept = 32;

std::string text(const char* format, double value) {
  char buffer[64];
  std::snprintf(buffer, sizeof(buffer), format, value);
  return buffer;
}

/// Appends to a list of words.
void append(const std::string& words, std::string& list, const char* separator = ", ") {
  list += (list.empty() ? "" : separator) + words;
}

bool isPaired(std::size_t input) { return input == kFirst || input == kSecond; }

bool areUnset(const std::deque<ros::Time>& stamps) {
  return std::all_of(stamps.begin(), stamps.end(), [](const ros::Time& t) { return t.isZero(); });
}

/// Number of stamps later than all stamps of the other topic.
int countLater(const std::deque<ros::Time>& stamps, const std::deque<ros::Time>& others) {
  const ros::Time newest = *std::max_element(others.begin(), others.end());
  return static_cast<int>(
      std::count_if(stamps.begin(), stamps.end(), [&](const ros::Time& t) { return t > newest; }));
}

}  // namespace

void SyncMonitor::restart(ros::SteadyTime now) {
  const std::lock_guard<std::mutex> lock(mutex_);
  beginWindow(now, kFirstReportS);
  stamps_ = {};
}

void SyncMonitor::received(std::size_t input, const ros::Time& stamp) {
  const std::lock_guard<std::mutex> lock(mutex_);
  Topic& topic = topics_.at(input);
  has_ever_come_[input] = true;
  ++topic.count;
  topic.stamps.push_back(stamp);
  if (topic.stamps.size() > kStampsKept) {
    topic.stamps.pop_front();
  }
  compare(stamp, stamps_[input]);
}

/// Records stamps that go back or repeat.
void SyncMonitor::compare(const ros::Time& stamp, Stamps& stamps) {
  const auto before = std::exchange(stamps.newest, stamp);
  if (before == stamp) {
    ++stamps.repeated;
  } else if (before && stamp < *before) {
    stamps.largest_step_back_s =
        std::max(stamps.largest_step_back_s, secondsBetween(stamp, *before));
  }
}

std::string SyncMonitor::reportStamps(const std::array<std::string, kInputs>& names) {
  const std::lock_guard<std::mutex> lock(mutex_);
  std::string back;
  std::string repeated;
  for (const std::size_t input : {kFirst, kSecond}) {
    Stamps& stamps = stamps_[input];
    if (stamps.largest_step_back_s > 0) {
      append(names[input] + text(" (%.3f s)", stamps.largest_step_back_s), back);
    }
    if (stamps.repeated > 0) {
      append(names[input] + text(" (%.0f times)", stamps.repeated), repeated);
    }
    stamps.largest_step_back_s = 0;
    stamps.repeated = 0;
  }
  std::string message;
  if (!back.empty()) {
    append("stamps went back on " + back, message);
  }
  if (!repeated.empty()) {
    append("stamps were repeated on " + repeated, message);
  }
  return message;
}

void SyncMonitor::synchronized(ros::SteadyTime now) {
  const std::lock_guard<std::mutex> lock(mutex_);
  beginWindow(now, patience_s_);
}

std::string SyncMonitor::report(ros::SteadyTime now, const TopicStates& states) {
  const std::lock_guard<std::mutex> lock(mutex_);
  const double elapsed_s = (now - window_start_).toSec();
  if (elapsed_s < patience_s_) {
    return {};
  }
  std::string message = describe(states, elapsed_s);
  beginWindow(now, kNextReportS);
  return message;
}

void SyncMonitor::beginWindow(ros::SteadyTime now, double patience_s) {
  topics_ = {};
  window_start_ = now;
  patience_s_ = patience_s;
}

std::string SyncMonitor::describe(const TopicStates& states, double elapsed_s) const {
  std::string topics;
  for (std::size_t i = 0; i < kInputs; ++i) {
    append(describeTopic(i, states[i], elapsed_s), topics);
  }
  std::string message =
      "no synchronized set of messages in " + text("%.0f", elapsed_s) + " s: " + topics;
  const std::string what_to_do = advice(states, elapsed_s);
  return what_to_do.empty() ? message : message + "; " + what_to_do;
}

std::string SyncMonitor::describeTopic(std::size_t input, const TopicState& state,
                                       double elapsed_s) const {
  const Topic& topic = topics_[input];
  if (topic.count == 0 && !isPaired(input) && has_ever_come_[input]) {
    return state.name + " no new message (the last one is used)";
  }
  if (topic.count == 0) {
    return state.name + (state.has_publisher ? " no message (it has a publisher)"
                                             : " no message (no publisher)");
  }
  std::string words = state.name + text(" %.1f Hz", static_cast<double>(topic.count) / elapsed_s);
  if (input == kSecond && bothArrive()) {
    words += " (stamps " + durationText(typicalDistanceS()) + " from the first topic's)";
  }
  return words;
}

/// What to do; empty if the list of silent topics is sufficient.
std::string SyncMonitor::advice(const TopicStates& states, double elapsed_s) const {
  std::string unpublished;
  std::string uncalibrated;
  for (std::size_t i = 0; i < kInputs; ++i) {
    if (topics_[i].count == 0 && isPaired(i) && !states[i].has_publisher) {
      append(states[i].name, unpublished);
    }
    if (!isPaired(i) && !has_ever_come_[i]) {
      append(states[i].name, uncalibrated);
    }
  }
  std::string message;
  if (!unpublished.empty()) {
    append("remap " + unpublished + " to the image topics (rostopic list shows them)", message,
           "; ");
  }
  if (!uncalibrated.empty()) {
    append("each camera needs its calibration: calibrate with camera_calibration and publish " +
               uncalibrated + " with every image or once (latched)",
           message, "; ");
  }
  if (bothArrive() && uncalibrated.empty()) {
    StampRelation stamps = relation(elapsed_s);
    stamps.first = states[kFirst].name;
    stamps.second = states[kSecond].name;
    append(syncAdvice(options_, stamps), message, "; ");
  }
  return message;
}

/// Both topics must have messages.
StampRelation SyncMonitor::relation(double elapsed_s) const {
  StampRelation relation;
  relation.distance_s = typicalDistanceS();
  relation.period_s = elapsed_s / static_cast<double>(topics_[kFirst].count);
  relation.first_is_unset = areUnset(topics_[kFirst].stamps);
  relation.second_is_unset = areUnset(topics_[kSecond].stamps);
  relation.lag = lag();
  return relation;
}

/// Median distance of a stamp of the second topic to the nearest stamp of the first.
double SyncMonitor::typicalDistanceS() const {
  std::vector<double> distances;
  for (const ros::Time& stamp : topics_[kSecond].stamps) {
    double nearest = std::numeric_limits<double>::infinity();
    for (const ros::Time& other : topics_[kFirst].stamps) {
      nearest = std::min(nearest, std::abs(secondsBetween(stamp, other)));
    }
    distances.push_back(nearest);
  }
  const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
  std::nth_element(distances.begin(), middle, distances.end());
  return *middle;
}

int SyncMonitor::lag() const {
  const auto& firsts = topics_[kFirst].stamps;
  const auto& seconds = topics_[kSecond].stamps;
  return std::max(countLater(firsts, seconds), countLater(seconds, firsts));
}

}  // namespace cbmv
