#pragma once

#include <opencv2/core.hpp>

#include "base/volume.h"

#include "cbmv_stereo/disparity_range.h"

namespace cbmv {

/// Sub-pixel enhancement (Žbontar & LeCun 2016, section 4.4): with d the whole-pixel disparity and
/// C−, C, C+ the costs at d − 1, d, d + 1,
///   D = d − (C+ − C−) / (2 (C+ − 2 C + C−)).
/// A pixel stays as it is when it is invalid or not a whole number, at the ends of the range, next
/// to a hypothesis whose match lies outside of the other image, and where the costs have no strict
/// minimum at d: C > C−, C > C+, or all three equal (filled pixels, mostly). |D − d| ≤ 0.5.
///
/// `disparity` (CV_32FC1, of `view`) is changed in place. Parallel over rows by oneTBB.
void refineSubpixel(const OptimizedVolume& costs, View view, const DisparityRange& range,
                    cv::Mat& disparity);

}  // namespace cbmv
