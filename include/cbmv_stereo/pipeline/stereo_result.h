#pragma once

#include <opencv2/core.hpp>

#include "cbmv_stereo/rectification/vertical_offset.h"
#include "cbmv_stereo/refinement/left_right_check.h"
#include "cbmv_stereo/volume/disparity_range.h"

namespace cbmv {

/// Wall-clock time of each stage of one frame, in milliseconds.
struct StageTimes {
  double rectification_ms = 0;
  double volume_ms = 0;  ///< matching, confidence, forest: one pass over the rows
  double aggregation_ms = 0;
  double sgm_ms = 0;
  double refinement_ms = 0;  ///< winner takes all, check, filling, sub-pixel, filters, confidence
  double total_ms = 0;
};

/// What the method finds for one rectified pair. All maps have the size of the images.
struct StereoResult {
  DisparityRange range;  ///< that was searched; never automatic
  cv::Mat disparity;  ///< CV_32FC1, px, left view, after all refinement; range.invalid() = none
  cv::Mat right_disparity;  ///< CV_32FC1, px, right view, winner takes all; empty without the check
  cv::Mat labels;           ///< CV_8UC1 of Label, left view: what the left-right check found
  /// CV_32FC1 in [0, 1], left view: the forest's probability that the whole-pixel disparity chosen
  /// is correct; halved where the left-right check failed, and 0 where there is no disparity.
  cv::Mat confidence;
  /// CV_32FC1, px, left view: standard deviation of the disparity's error, given that the pixel is
  /// an inlier (|error| ≤ 1 px; `confidence` is the probability of that). Above 0; NaN where there
  /// is no disparity. Empty without a second forest.
  cv::Mat disparity_sigma;
  /// That the matcher needs for this pair, MB of 2^20 bytes (memory.h).
  double memory_mb = 0;
  VerticalOffset rectification;  ///< the model that was removed before matching
  StageTimes times;
};

}  // namespace cbmv
