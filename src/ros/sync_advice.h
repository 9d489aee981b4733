#pragma once

#include <string>

#include "ros/stamp_pairing.h"

namespace cbmv {

/// Relation between the stamps of two topics whose messages arrive without forming pairs.
struct StampRelation {
  std::string first;  ///< topic name
  std::string second;
  double distance_s = 0;  ///< median distance of a stamp of the second to the nearest of the first
  double period_s = 0;    ///< between messages of the first
  bool first_is_unset = false;  ///< all stamps are zero
  bool second_is_unset = false;
  int lag = 0;  ///< number of messages by which one topic is behind the other
};

/// Explains in one message why there are no pairs and what to do.
std::string syncAdvice(const SyncOptions& options, const StampRelation& relation);

/// A time in a suitable unit: "4.0 ms", "50.0 years".
std::string durationText(double seconds);

}  // namespace cbmv
