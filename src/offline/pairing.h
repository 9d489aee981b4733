#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include <ros/time.h>

namespace cbmv {

/// An image as far as pairing it goes.
struct StampedImage {
  ros::Time stamp;
  std::size_t place = 0;  ///< in the recording, among the images of both cameras
};

/// Which images of two cameras belong together.
struct StampPairs {
  std::vector<std::pair<std::size_t, std::size_t>> pairs;  ///< left and right, by stamp
  std::vector<std::size_t> left_alone;                     ///< without a partner
  std::vector<std::size_t> right_alone;
  std::vector<std::size_t> left_repeated;  ///< beyond the partners of their stamp
  std::vector<std::size_t> right_repeated;
};

/// Two images are a pair if each is the nearest in time to the other, and their stamps differ by
/// `max_difference_s` (0: not at all) at most. Of images of equal stamps those are paired that the
/// live node pairs: an image that finds one of the other camera waiting takes it; a later one of
/// the same camera replaces one that waits. So where a right image was lost of pairs that were
/// recorded left, right, those after it stay together; where a left one was lost, they do not. Pairs
/// are in the order of the left stamps, then of the recording.
StampPairs pairStamps(const std::vector<StampedImage>& left, const std::vector<StampedImage>& right,
                      double max_difference_s);

/// Time between two stamps in nanoseconds, whichever is earlier.
std::int64_t distanceNs(const ros::Time& a, const ros::Time& b);

/// Index of the stamp nearest to `stamp`, the earlier one of two; `stamps` is sorted and not empty.
std::size_t nearestStamp(const std::vector<ros::Time>& stamps, const ros::Time& stamp);

}  // namespace cbmv
