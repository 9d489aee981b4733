#pragma once

#include <opencv2/core.hpp>

#include "base/volume.h"

#include "cbmv_stereo/disparity_range.h"

namespace cbmv {

/// Subpixel enhancement (Žbontar & LeCun 2016, section 4.4). With the whole-pixel disparity d and
/// the costs C−, C, C+ at d − 1, d, d + 1:
///   D = d − (C+ − C−) / (2 (C+ − 2 C + C−)), |D − d| ≤ 0.5.
/// A pixel does not change if
/// - it is invalid or not a whole number;
/// - it is at the ends of the range;
/// - it is next to a hypothesis whose match is outside of the other image;
/// - the costs have no strict minimum at d: C > C−, C > C+, or all three are equal (mostly filled
///   pixels).
///
/// Changes `disparity` (CV_32FC1, of `view`) in place. Parallel over rows by oneTBB.
void refineSubpixel(const AggregatedVolume& costs, View view, const DisparityRange& range,
                    cv::Mat& disparity);

}  // namespace cbmv
