#include "offline/pairing.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "ros/stamps.h"

namespace cbmv {
namespace {

/// Sorted stamps, each once, and the images that have them, in the order of the recording.
struct SortedStamps {
  std::vector<ros::Time> stamps;
  std::vector<std::vector<std::size_t>> images;
};

SortedStamps sortStamps(const std::vector<ros::Time>& stamps) {
  std::vector<std::size_t> order(stamps.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return stamps[a] < stamps[b]; });
  SortedStamps sorted;
  for (const std::size_t index : order) {
    if (sorted.stamps.empty() || sorted.stamps.back() != stamps[index]) {
      sorted.stamps.push_back(stamps[index]);
      sorted.images.emplace_back();
    }
    sorted.images.back().push_back(index);
  }
  return sorted;
}

/// Pairs the images of one left and one right stamp.
void addPairs(const std::vector<std::size_t>& left, const std::vector<std::size_t>& right,
              StampPairs& result) {
  const std::size_t count = std::min(left.size(), right.size());
  for (std::size_t i = 0; i < count; ++i) {
    result.pairs.emplace_back(left[i], right[i]);
  }
  const auto add_rest = [count](const auto& images, std::vector<std::size_t>& repeated) {
    repeated.insert(repeated.end(), images.begin() + static_cast<std::ptrdiff_t>(count),
                    images.end());
  };
  add_rest(left, result.left_repeated);
  add_rest(right, result.right_repeated);
}

void append(const std::vector<std::size_t>& images, std::vector<std::size_t>& list) {
  list.insert(list.end(), images.begin(), images.end());
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
  const SortedStamps lefts = sortStamps(left);
  const SortedStamps rights = sortStamps(right);
  const double bound_ns = std::round(std::max(0.0, max_difference_s) * 1e9);
  std::vector<bool> taken(rights.stamps.size(), false);
  for (std::size_t i = 0; i < lefts.stamps.size(); ++i) {
    const ros::Time& stamp = lefts.stamps[i];
    const std::size_t j = rights.stamps.empty() ? 0 : nearestStamp(rights.stamps, stamp);
    const bool is_pair = !rights.stamps.empty() &&
                         static_cast<double>(distanceNs(stamp, rights.stamps[j])) <= bound_ns &&
                         nearestStamp(lefts.stamps, rights.stamps[j]) == i;
    if (is_pair) {
      addPairs(lefts.images[i], rights.images[j], result);
      taken[j] = true;
    } else {
      append(lefts.images[i], result.left_alone);
    }
  }
  for (std::size_t j = 0; j < taken.size(); ++j) {
    if (!taken[j]) {
      append(rights.images[j], result.right_alone);
    }
  }
  return result;
}

}  // namespace cbmv
