#pragma once

#include <opencv2/core.hpp>

#include "cbmv_stereo/disparity_range.h"

namespace cbmv {

/// Memory of removeSpeckles, kept from frame to frame.
struct SpeckleBuffers {
  static constexpr double kBytesPerPixel = 2 + 9;  ///< 16-bit disparities, OpenCV's regions

  cv::Mat steps;  ///< disparities as integers, CV_16SC1
  cv::Mat regions;
};

/// Invalidates speckles: regions of at most `size_px` pixels. A region is connected by neighbors
/// above, below, left and right whose disparities differ by at most `difference_px`. size_px = 0
/// changes nothing.
///
/// Uses cv::filterSpeckles, as stereo_image_proc does, with disparities in units of 1/16 px. For
/// more than 2000 disparities the unit is coarser, so that values fit 16 bits. `disparity`
/// (CV_32FC1) is changed in place; range.invalid() marks invalid pixels.
void removeSpeckles(const DisparityRange& range, int size_px, int difference_px,
                    SpeckleBuffers& buffers, cv::Mat& disparity);

}  // namespace cbmv
