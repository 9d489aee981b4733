#pragma once

#include <cstdint>
#include <vector>

namespace cbmv {

/// What is known of training samples beside their features.
struct SampleLabels {
  std::vector<std::uint8_t> labels;    ///< 1 correct, 0 wrong
  std::vector<std::uint8_t> held_out;  ///< 1: for measuring only, 0: to train on

  long count() const { return static_cast<long>(labels.size()); }
};

}  // namespace cbmv
