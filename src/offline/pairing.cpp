#include "offline/pairing.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>
#include <utility>

#include "ros/stamps.h"

namespace cbmv {
namespace {

/// Unique sorted stamps, and their images in the order of the bag.
struct SortedStamps {
  std::vector<ros::Time> stamps;
  std::vector<std::vector<std::size_t>> images;
};

SortedStamps sortStamps(const std::vector<StampedImage>& images) {
  std::vector<std::size_t> order(images.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return std::tie(images[a].stamp, images[a].place) < std::tie(images[b].stamp, images[b].place);
  });
  SortedStamps sorted;
  for (const std::size_t index : order) {
    if (sorted.stamps.empty() || sorted.stamps.back() != images[index].stamp) {
      sorted.stamps.push_back(images[index].stamp);
      sorted.images.emplace_back();
    }
    sorted.images.back().push_back(index);
  }
  return sorted;
}

/// Arrival of an image.
struct Arrival {
  std::size_t place;
  bool is_right;
  std::size_t image;
};

/// Pairs the images of one left and one right stamp in the order of `arrivals`.
void addPairs(const std::vector<Arrival>& arrivals, StampPairs& result) {
  const auto leave = [&result](const Arrival& image) {
    (image.is_right ? result.right_repeated : result.left_repeated).push_back(image.image);
  };
  const Arrival* waiting = nullptr;  // at most one image waits: two would be a pair
  for (const Arrival& next : arrivals) {
    if (waiting != nullptr && waiting->is_right != next.is_right) {
      const auto [left, right] = next.is_right ? std::pair(waiting->image, next.image)
                                               : std::pair(next.image, waiting->image);
      result.pairs.emplace_back(left, right);
      waiting = nullptr;
      continue;
    }
    if (waiting != nullptr) {
      leave(*waiting);
    }
    waiting = &next;
  }
  if (waiting != nullptr) {
    leave(*waiting);
  }
}

std::vector<Arrival> arrivalsOf(const std::vector<std::size_t>& left_numbers,
                                const std::vector<StampedImage>& left,
                                const std::vector<std::size_t>& right_numbers,
                                const std::vector<StampedImage>& right) {
  std::vector<Arrival> arrivals;
  for (const std::size_t l : left_numbers) {
    arrivals.push_back({left[l].place, false, l});
  }
  for (const std::size_t r : right_numbers) {
    arrivals.push_back({right[r].place, true, r});
  }
  std::stable_sort(arrivals.begin(), arrivals.end(),
                   [](const Arrival& a, const Arrival& b) { return a.place < b.place; });
  return arrivals;
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

StampPairs pairStamps(const std::vector<StampedImage>& left, const std::vector<StampedImage>& right,
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
      addPairs(arrivalsOf(lefts.images[i], left, rights.images[j], right), result);
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
