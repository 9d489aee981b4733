#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include <ros/time.h>

namespace cbmv {

/// Stamp and position of an image, for pairing.
struct StampedImage {
  ros::Time stamp;
  std::size_t place = 0;  ///< index in the bag among the images of both cameras
};

/// Result of pairing the images of two cameras.
struct StampPairs {
  std::vector<std::pair<std::size_t, std::size_t>>
      pairs;                            ///< indices of left and right image, by stamp
  std::vector<std::size_t> left_alone;  ///< images without a partner
  std::vector<std::size_t> right_alone;
  std::vector<std::size_t> left_repeated;  ///< surplus images with the stamp of a pair
  std::vector<std::size_t> right_repeated;
};

/// Two images are a pair if each is the nearest in time to the other and their stamps differ by at
/// most `max_difference_s` (0: equal stamps only). Images with equal stamps are paired as in the
/// node: an image takes a waiting image of the other camera; a later image of the same camera
/// replaces a waiting one. If pairs are recorded left first, later pairs stay correct after a lost
/// right image, but not after a lost left image. Pairs are sorted by left stamp, then by position
/// in the bag.
StampPairs pairStamps(const std::vector<StampedImage>& left, const std::vector<StampedImage>& right,
                      double max_difference_s);

/// Absolute difference of two stamps in nanoseconds.
std::int64_t distanceNs(const ros::Time& a, const ros::Time& b);

/// Index of the stamp nearest to `stamp`; the earlier one of two at equal distance. `stamps` is
/// sorted and not empty.
std::size_t nearestStamp(const std::vector<ros::Time>& stamps, const ros::Time& stamp);

}  // namespace cbmv
