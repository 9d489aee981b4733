#pragma once

#include <opencv2/core.hpp>

#include "cbmv_stereo/disparity_label.h"
#include "cbmv_stereo/disparity_range.h"
#include "cbmv_stereo/vertical_offset.h"

namespace cbmv {

/// Wall time of each stage for one frame, in ms.
struct StageTimes {
  double rectification_ms = 0;
  double volume_ms = 0;  ///< matching, features, forest: one pass over the rows
  double aggregation_ms = 0;
  double sgm_ms = 0;
  /// WTA, left-right consistency check, filling, subpixel, filters, confidence
  double refinement_ms = 0;
  double selection_ms = 0;  ///< second forest
  double total_ms = 0;
};

/// Result of the method for one rectified pair. All maps have the size of the images.
struct StereoResult {
  DisparityRange range;  ///< the range that was searched; never automatic
  cv::Mat disparity;     ///< CV_32FC1, px, left view, after all refinement; none: range.invalid()
  cv::Mat right_disparity;  ///< CV_32FC1, px, right view, after WTA; empty without the check
  cv::Mat labels;  ///< CV_8UC1 of Label, left view: result of the left-right consistency check
  /// CV_32FC1 in [0, 1], left view. With a second forest: its probability that the disparity is
  /// within 1 px of the true disparity, recalibrated by RefinementOptions::confidence_scale and
  /// confidence_shift; 0 where there is no disparity. Without a second forest: the
  /// probability from the first forest that the whole-pixel winner is correct, halved where the
  /// left-right consistency check failed.
  cv::Mat confidence;
  /// CV_16UC1, unit 1/255, left view: the lowest aggregated cost at a distance of more than 1 px
  /// from the whole-pixel winner, minus the cost of the winner. 65535 where there is no hypothesis
  /// at that distance. Refinement does not change it.
  cv::Mat margin;
  /// CV_32FC1, px, left view: standard deviation of the disparity error of an inlier (|error| ≤ 1
  /// px), multiplied by RefinementOptions::sigma_scale. Above 0; NaN where there is no disparity.
  /// Empty without a second forest.
  cv::Mat disparity_sigma;
  /// Memory that the matcher needs for this pair, in MB of 2^20 bytes (memory.h).
  double memory_mb = 0;
  VerticalOffset rectification;  ///< the model that was removed before matching
  StageTimes times;
};

}  // namespace cbmv
