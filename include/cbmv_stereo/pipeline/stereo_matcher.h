#pragma once

#include <memory>

#include <opencv2/core.hpp>

#include "cbmv_stereo/forest/forest.h"
#include "cbmv_stereo/pipeline/options.h"
#include "cbmv_stereo/rectification/vertical_offset.h"
#include "cbmv_stereo/refinement/left_right_check.h"

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
  DisparityRange range;
  cv::Mat disparity;  ///< CV_32FC1, px, left view, after all refinement; range.invalid() = none
  cv::Mat right_disparity;  ///< CV_32FC1, px, right view, winner takes all; empty without the check
  cv::Mat labels;           ///< CV_8UC1 of Label, left view: what the left-right check found
  /// CV_32FC1 in [0, 1], left view: the forest's probability that the whole-pixel disparity chosen
  /// is correct; halved where the left-right check failed, and 0 where there is no disparity.
  cv::Mat confidence;
  VerticalOffset rectification;  ///< the model that was removed before matching
  StageTimes times;
};

/// The whole method on rectified pairs: the one class that nodelet, tools and tests call.
///
/// Holds the buffers of a frame, so one object serves one frame at a time; use one object per
/// thread. Several can live side by side. Results depend on the images, options, forest and
/// rectification model only, not on earlier frames nor on the number of threads.
class StereoMatcher {
 public:
  /// Throws Error if `options` are inconsistent (correctOptions mends them).
  StereoMatcher(std::shared_ptr<const Forest> forest, const StereoOptions& options);
  ~StereoMatcher();
  StereoMatcher(const StereoMatcher&) = delete;
  StereoMatcher& operator=(const StereoMatcher&) = delete;

  const StereoOptions& options() const;
  /// From the next frame on. Throws Error as the constructor does and then changes nothing.
  void setOptions(const StereoOptions& options);

  /// One pair by itself: the vertical offset is estimated from this pair (if switched on), removed,
  /// and the pair matched. Both images CV_8UC1 of the same size, not empty; throws Error otherwise.
  StereoResult match(const cv::Mat& left, const cv::Mat& right);

  /// A frame of a stream: the vertical offset is given (RectificationTracker estimates it in the
  /// background).
  StereoResult match(const cv::Mat& left, const cv::Mat& right, const VerticalOffset& offset);

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace cbmv
