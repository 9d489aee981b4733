#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include "cbmv_stereo/rectification/vertical_offset.h"

namespace cbmv {

/// One point seen by both cameras.
struct SparseMatch {
  double x_right;  ///< column in the right image, px
  double y_left;   ///< row in the left image, px
  double dy;       ///< row in the right image minus row in the left one, px
};

/// Throws Error unless the images have one size and are CV_8UC1.
void requireGreyPair(const cv::Mat& left, const cv::Mat& right);

/// Matches of corners that are spread over the left image; most of them right, some wrong.
std::vector<SparseMatch> findSparseMatches(const cv::Mat& left, const cv::Mat& right,
                                           const DisparityRange& range,
                                           const RectificationOptions& options);

}  // namespace cbmv
