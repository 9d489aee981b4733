#pragma once

#include <cstdint>
#include <cstring>

#include "refinement/left_right_check.h"

namespace cbmv {

/// The first column from x on whose label is not kMatch; `width` if there is none. Most labels are
/// kMatch, so eight are tested at once.
inline int firstUnmatched(const std::uint8_t* labels, int x, int width) {
  static_assert(kMatch == 0);
  for (std::uint64_t eight = 0; x + 8 <= width; x += 8) {
    std::memcpy(&eight, labels + x, sizeof(eight));
    if (eight != 0) {
      break;
    }
  }
  while (x < width && labels[x] == kMatch) {
    ++x;
  }
  return x;
}

}  // namespace cbmv
