#pragma once

#include <string>

#include "ros/stamp_pairing.h"

namespace cbmv {

/// How the stamps of two topics lie, of which messages come but no pairs.
struct StampRelation {
  std::string first;  ///< topics
  std::string second;
  double distance_s = 0;        ///< median, from a stamp of the second to the nearest of the first
  double period_s = 0;          ///< between messages of the first
  bool first_is_unset = false;  ///< all stamps are zero
  bool second_is_unset = false;
  int lag = 0;  ///< messages by which one topic is behind the other
};

/// Why there are no pairs, and what to do: one sentence.
std::string syncAdvice(const SyncOptions& options, const StampRelation& relation);

/// A time in the unit that suits it: "4.0 ms", "50.0 years".
std::string durationText(double seconds);

}  // namespace cbmv
