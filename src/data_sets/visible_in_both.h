#pragma once

#include <opencv2/core.hpp>

namespace cbmv {

/// Non-occlusion map from the true disparities of the left image alone (CV_32FC1, NaN or infinity =
/// unknown): CV_8UC1, 255 where the disparity is known and both cameras see the point, else 0.
///
/// A pixel (x, d) lands at x − d in the right image. It is hidden when it lands more than half a
/// column outside of that image, or when another pixel of its row with a disparity larger by more
/// than 1 px lands less than one column away from it: a nearer surface covers it there. The margin
/// of 1 px keeps slanted surfaces (up to 1/2 px of disparity a column) from hiding themselves.
cv::Mat visibleInBoth(const cv::Mat& truth);

}  // namespace cbmv
