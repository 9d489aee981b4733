#include "ros/sync_advice.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>
#include <utility>

namespace cbmv {
namespace {

/// Limits of the suggested interval. Free-running cameras with equal rates differ by at most half a
/// period.
constexpr double kLowestBoundS = 0.1;
constexpr double kHighestBoundS = 0.5;

double fixed(double value) { return std::round(value * 1000) / 1000; }

/// Adds a margin and rounds up to whole milliseconds.
double neededIntervalS(double distance_s) { return std::ceil(1.5 * distance_s * 1000) / 1000; }

std::string unsetAdvice(const std::string& topic) {
  return "the stamps of " + topic +
         " are zero: set header.stamp to the time of exposure in the driver";
}

std::string clockAdvice(const StampRelation& relation) {
  return "the stamps of " + relation.second + " are " + durationText(relation.distance_s) +
         " from those of " + relation.first +
         ": the clocks of the two sources differ, or one of them does not set header.stamp. "
         "Synchronize the clocks (chrony, PTP), or correct the driver. When playing bags, play "
         "both topics from the same bag";
}

std::string queueAdvice(const SyncOptions& options, const StampRelation& relation) {
  std::ostringstream text;
  text << "the stamps match, but one topic is late: increase the parameter queue_size from "
       << options.queue_size << " to " << std::max(2 * options.queue_size, relation.lag + 2);
  return text.str();
}

std::string intervalAdvice(const SyncOptions& options, const StampRelation& relation) {
  const double needed_s = neededIntervalS(relation.distance_s);
  std::ostringstream text;
  if (options.approximate) {
    text << "increase the parameter approximate_sync_max_interval_s from "
         << fixed(options.max_interval_s) << " to " << needed_s;
  } else {
    text << "the stamps are not equal: trigger the cameras together, or set the parameters "
            "approximate_sync to true and approximate_sync_max_interval_s to "
         << needed_s;
  }
  return text.str();
}

}  // namespace

std::string syncAdvice(const SyncOptions& options, const StampRelation& relation) {
  if (relation.first_is_unset != relation.second_is_unset) {
    return unsetAdvice(relation.first_is_unset ? relation.first : relation.second);
  }
  const bool unbounded = options.approximate && options.max_interval_s <= 0;
  const double allowed_s = options.approximate ? options.max_interval_s : 0;
  if (unbounded || relation.distance_s <= allowed_s) {
    return queueAdvice(options, relation);
  }
  const double bound_s = std::clamp(relation.period_s / 2, kLowestBoundS, kHighestBoundS);
  return relation.distance_s > bound_s ? clockAdvice(relation) : intervalAdvice(options, relation);
}

std::string durationText(double seconds) {
  constexpr double kDayS = 86400;
  constexpr double kYearS = 365.25 * kDayS;
  constexpr std::array<std::pair<double, const char*>, 4> kUnits = {
      std::pair(kYearS, "years"), {kDayS, "days"}, {3600, "h"}, {1, "s"}};
  const auto unit = std::find_if(kUnits.begin(), kUnits.end(),
                                 [&](const auto& candidate) { return seconds >= candidate.first; });
  std::ostringstream text;
  text.precision(1);
  text << std::fixed;
  if (unit == kUnits.end()) {
    text << seconds * 1000 << " ms";
  } else {
    text << seconds / unit->first << " " << unit->second;
  }
  return text.str();
}

}  // namespace cbmv
