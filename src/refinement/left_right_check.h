#pragma once

#include <cstdint>
#include <cstring>

#include <opencv2/core.hpp>

#include "cbmv_stereo/disparity_label.h"
#include "cbmv_stereo/disparity_range.h"

namespace cbmv {

/// Left-right consistency check (Mei et al. 2011, section 2.4; Žbontar & LeCun 2016, section 4.3)
/// for the left view, with D_L(x) = d:
/// - match if |d − D_R(x − d)| ≤ max_difference_px;
/// - otherwise mismatched if |d' − D_R(x − d')| ≤ max_difference_px for another d' of the range;
/// - otherwise occluded.
///
/// Columns are rounded to the nearest pixel (std::lround). Columns outside of the right image and
/// invalid pixels of either image agree with nothing. d' are whole pixels and are also tested for
/// invalid pixels of the left image.
///
/// Both disparities are CV_32FC1 of the same size; range.invalid() marks invalid pixels. `labels`
/// becomes CV_8UC1 of Label. Parallel over rows by oneTBB.
void leftRightCheck(const cv::Mat& left_disparity, const cv::Mat& right_disparity,
                    const DisparityRange& range, float max_difference_px, cv::Mat& labels);

/// The first column from x on whose label is not kMatch; `width` if there is none. Most labels are
/// kMatch, so eight are compared at once.
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
