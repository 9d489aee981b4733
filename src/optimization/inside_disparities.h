#pragma once

#include <algorithm>

#include <opencv2/core.hpp>

#include "cbmv_stereo/disparity_range.h"

namespace cbmv {

/// Indices [start, end) of the disparities of column x whose match is inside of the other image,
/// which is `width` pixels wide. Empty if there are none.
inline cv::Range insideDisparities(View view, const DisparityRange& range, int x, int width) {
  // The disparities that match the first and the last column of the other image.
  const int lowest = view == View::kLeft ? x - (width - 1) : -x;
  const int highest = view == View::kLeft ? x : width - 1 - x;
  const int start = std::clamp(lowest - range.min, 0, range.count);
  const int end = std::clamp(highest - range.min + 1, start, range.count);
  return {start, end};
}

}  // namespace cbmv
