#pragma once

#include <opencv2/core.hpp>

#include "cbmv_stereo/disparity_range.h"

namespace cbmv {

/// Memory of removeSpeckles, kept from frame to frame.
struct SpeckleBuffers {
  cv::Mat steps;  ///< disparities in steps, CV_16SC1
  cv::Mat regions;
};

/// Takes the disparity from speckles: regions of at most `size_px` pixels. A region is what is
/// connected by neighbors above, below, left and right whose disparities differ by at most
/// `difference_px`. size_px = 0 changes nothing.
///
/// This is cv::filterSpeckles, as stereo_image_proc has it. It counts in steps of 1/16 px; with
/// more than 2000 disparities in coarser ones, so that they fit 16 bits. `disparity` (CV_32FC1) is
/// changed in place and has range.invalid() as the invalid mark.
void removeSpeckles(const DisparityRange& range, int size_px, int difference_px,
                    SpeckleBuffers& buffers, cv::Mat& disparity);

}  // namespace cbmv
