#pragma once

#include <opencv2/core.hpp>

#include "cbmv_stereo/disparity_label.h"
#include "cbmv_stereo/disparity_range.h"
#include "cbmv_stereo/vertical_offset.h"

namespace cbmv {

/// Wall-clock time of each stage of one frame, in milliseconds.
struct StageTimes {
  double rectification_ms = 0;
  double volume_ms = 0;  ///< matching, confidence, forest: one pass over the rows
  double aggregation_ms = 0;
  double sgm_ms = 0;
  double refinement_ms = 0;  ///< winner takes all, check, filling, sub-pixel, filters, confidence
  double selection_ms = 0;   ///< second forest
  double total_ms = 0;
};

/// What the method finds for one rectified pair. All maps have the size of the images.
struct StereoResult {
  DisparityRange range;  ///< that was searched; never automatic
  cv::Mat disparity;     ///< CV_32FC1, px, left view, after all refinement; range.invalid() = none
  cv::Mat right_disparity;  ///< CV_32FC1, px, right view, winner takes all; empty without the check
  cv::Mat labels;           ///< CV_8UC1 of Label, left view: what the left-right check found
  /// CV_32FC1 in [0, 1], left view: the probability that the disparity is within 1 px of the truth,
  /// by the second forest; 0 where there is no disparity. Without a second forest: the first
  /// forest's probability that the whole-pixel disparity chosen is correct, halved where the
  /// left-right check failed.
  cv::Mat confidence;
  /// CV_16UC1, unit 1/255, left view: the lowest aggregated cost more than 1 px beside the
  /// whole-pixel disparity chosen by winner takes all, minus the cost of that one. 65535 where
  /// there is no such hypothesis. Refinement does not change it.
  cv::Mat margin;
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
