#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "ros/conversions.h"

#include "cbmv_stereo/forest/forest.h"
#include "cbmv_stereo/pipeline/stereo_matcher.h"
#include "cbmv_stereo/rectification/tracker.h"

namespace cbmv {

/// What comes of one set of input messages.
struct ProcessedFrame {
  cv::Mat left_grey;  ///< CV_8UC1; may share the memory of the left image's message
  StereoGeometry geometry;
  StereoResult result;
  double disparity_step_px = 0;
  double memory_mb = 0;  ///< that the method holds for images of that size
  RectificationState rectification;
  std::string range_correction;  ///< one sentence if not all disparities asked for fit; else empty
};

/// The disparities of `range` that have a match in images of that width. Throws InputError if there
/// are none.
DisparityRange clipRange(const DisparityRange& range, int image_width);

/// The options `wanted`, with the range clipped to images of that size. Throws InputError, whose
/// sentence begins with `prefix` where that is about memory, if the images cannot be matched so.
StereoOptions optionsFor(cv::Size image_size, const StereoOptions& wanted,
                         const std::string& prefix = "");

/// The method on a stream of messages: checks and converts, tracks the vertical offset, matches.
class StereoProcessor {
 public:
  /// Throws Error if the options are inconsistent.
  StereoProcessor(std::shared_ptr<const Forest> forest, const StereoOptions& options,
                  bool allow_different_frame_ids);

  /// From the next frame on; may be called while a frame is processed. The options have to be
  /// consistent (correctOptions).
  void setOptions(const StereoOptions& options);

  /// From the next frame on, pixels of a lower confidence, in [0, 1], have no disparity. The
  /// confidence itself stays. May be called while a frame is processed.
  void setMinConfidence(float min_confidence) { min_confidence_ = min_confidence; }

  /// One frame at a time. Throws InputError if the messages do not fit.
  ProcessedFrame process(const StereoMessages& messages, const StereoTopics& topics);

 private:
  void takeNewOptions();
  void adaptTo(cv::Size image_size, const std::string& image_topic);
  void followRectification(const RectificationOptions& options);
  RectificationState rectificationState(double now_s) const;

  const bool allow_different_frame_ids_;
  StereoMatcher matcher_;
  StereoOptions options_;  ///< as asked for; the matcher's have the range clipped to the images
  /// Follows the offset for as long as its options stay; the size of images it watches itself.
  std::optional<RectificationTracker> tracker_;
  RectificationOptions tracker_options_;
  std::optional<cv::Size> adapted_size_;  ///< empty: the matcher does not have options_ yet
  std::string range_correction_;
  double memory_mb_ = 0;

  std::atomic<float> min_confidence_{0};
  std::mutex new_options_mutex_;
  std::optional<StereoOptions> new_options_;
};

}  // namespace cbmv
