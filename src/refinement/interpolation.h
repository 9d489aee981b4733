#pragma once

#include <opencv2/core.hpp>

#include "cbmv_stereo/disparity_range.h"

namespace cbmv {

/// Occlusions belong to the background (Žbontar & LeCun 2016, section 4.3): each takes the
/// disparity of the nearest match to its left on the row, which in the left view is the
/// background's. The border strip that has no match to its left takes the median of the first
/// matches of nine rows around (the lower one of two; rows without a match or beyond the image do
/// not count): one wrong first match leaves no streak. Rows without any match become
/// range.invalid().
///
/// `disparity` (CV_32FC1) is changed in place at pixels that `labels` (CV_8UC1 of Label) calls
/// kOcclusion. Parallel over rows by oneTBB.
void fillOcclusions(const cv::Mat& labels, const DisparityRange& range, cv::Mat& disparity);

/// Mismatches (ibid.): each takes the median of the nearest matches in 16 directions, k · 22.5°. A
/// direction is walked in steps of one pixel along the image axis that it is closer to, the other
/// coordinate rounded to the nearest pixel; directions that leave the image without a match do not
/// count. The lower of the two middle values when their number is even; range.invalid() when there
/// is none.
///
/// Only pixels that `labels` calls kMatch count. `filled` (CV_32FC1) is changed at those that it
/// calls kMismatch; it shares no memory with `disparity`, since rows are filled in parallel (by
/// oneTBB). All maps have one size, sides below 2^15 px, and are continuous in memory.
void fillMismatches(const cv::Mat& labels, const DisparityRange& range, const cv::Mat& disparity,
                    cv::Mat& filled);

}  // namespace cbmv
