#pragma once

#include <cstdint>

namespace cbmv {

/// Result of the left-right consistency check per pixel: the values of a CV_8UC1 label map.
enum Label : std::uint8_t {
  kMatch = 0,      ///< both views agree
  kMismatch = 1,   ///< mismatched: the views disagree, but agree at another disparity
  kOcclusion = 2,  ///< occluded: no disparity of the range makes the views agree
};

}  // namespace cbmv
