#pragma once

#include <opencv2/core.hpp>

#include "cbmv_stereo/disparity_range.h"

namespace cbmv {

/// Fills occluded pixels from the background (Žbontar & LeCun 2016, section 4.3). An occluded pixel
/// gets the disparity of the nearest match to its left on the row, which in the left view is in the
/// background.
///
/// The strip at the left border has no match to its left. It gets the median of the first matches
/// of nine rows around it (the lower of two middle values; rows without a match or beyond the image
/// do not count). So a single wrong first match does not leave a streak. Rows without any match
/// become range.invalid().
///
/// Changes `disparity` (CV_32FC1) in place at pixels with the label kOcclusion in `labels` (CV_8UC1
/// of Label). Parallel over rows by oneTBB.
void fillOcclusions(const cv::Mat& labels, const DisparityRange& range, cv::Mat& disparity);

/// Fills mismatched pixels (Žbontar & LeCun 2016, section 4.3) with the median of the nearest
/// matches in 16 directions, k · 22.5°. A ray moves in steps of one pixel along the image axis that
/// is closer to its direction; the other coordinate is rounded to the nearest pixel. Directions
/// that leave the image without a match do not count. The result is the lower of two middle values,
/// and range.invalid() if no direction has a match.
///
/// Only pixels with the label kMatch in `labels` are used. `filled` (CV_32FC1) is changed at pixels
/// with the label kMismatch. It must not share memory with `disparity`, because rows are filled in
/// parallel (by oneTBB). All maps have the same size, sides below 2^15 px, and are continuous in
/// memory.
void fillMismatches(const cv::Mat& labels, const DisparityRange& range, const cv::Mat& disparity,
                    cv::Mat& filled);

}  // namespace cbmv
