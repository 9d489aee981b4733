#pragma once

#include <cstdint>

namespace cbmv {

/// What the left-right check found at a pixel. Values of a CV_8UC1 label map.
enum Label : std::uint8_t {
  kMatch = 0,      ///< both views agree
  kMismatch = 1,   ///< they disagree, but at another disparity they would agree
  kOcclusion = 2,  ///< no disparity of the range makes them agree: seen by one camera only
};

}  // namespace cbmv
