#include "offline/pairing.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "ros/stamps.h"

namespace cbmv {
namespace {

/// Sorted stamps, each once, and where they come from.
struct SortedStamps {
  std::vector<ros::Time> stamps;
  std::vector<std::size_t> indices;
};

SortedStamps sortStamps(const std::vector<ros::Time>& stamps, std::vector<std::size_t>& repeated) {
  std::vector<std::size_t> order(stamps.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return stamps[a] < stamps[b]; });
  SortedStamps sorted;
  for (const std::size_t index : order) {
    if (!sorted.stamps.empty() && sorted.stamps.back() == stamps[index]) {
      repeated.push_back(index);
    } else {
      sorted.stamps.push_back(stamps[index]);
      sorted.indices.push_back(index);
    }
  }
  return sorted;
}

}  // namespace

std::int64_t distanceNs(const ros::Time& a, const ros::Time& b) {
  return std::abs(nanosecondsBetween(a, b));
}

std::size_t nearestStamp(const std::vector<ros::Time>& stamps, const ros::Time& stamp) {
  const auto next = std::lower_bound(stamps.begin(), stamps.end(), stamp);
  if (next == stamps.begin()) {
    return 0;
  }
  const auto index = static_cast<std::size_t>(next - stamps.begin());
  if (next == stamps.end() || distanceNs(stamp, *(next - 1)) <= distanceNs(stamp, *next)) {
    return index - 1;
  }
  return index;
}

StampPairs pairStamps(const std::vector<ros::Time>& left, const std::vector<ros::Time>& right,
                      double max_difference_s) {
  StampPairs result;
  const SortedStamps lefts = sortStamps(left, result.left_repeated);
  const SortedStamps rights = sortStamps(right, result.right_repeated);
  const double bound_ns = std::round(std::max(0.0, max_difference_s) * 1e9);
  std::vector<bool> taken(rights.stamps.size(), false);
  for (std::size_t i = 0; i < lefts.stamps.size(); ++i) {
    const ros::Time& stamp = lefts.stamps[i];
    const std::size_t j = rights.stamps.empty() ? 0 : nearestStamp(rights.stamps, stamp);
    const bool is_pair = !rights.stamps.empty() &&
                         static_cast<double>(distanceNs(stamp, rights.stamps[j])) <= bound_ns &&
                         nearestStamp(lefts.stamps, rights.stamps[j]) == i;
    if (is_pair) {
      result.pairs.emplace_back(lefts.indices[i], rights.indices[j]);
      taken[j] = true;
    } else {
      result.left_alone.push_back(lefts.indices[i]);
    }
  }
  for (std::size_t j = 0; j < taken.size(); ++j) {
    if (!taken[j]) {
      result.right_alone.push_back(rights.indices[j]);
    }
  }
  return result;
}

}  // namespace cbmv
