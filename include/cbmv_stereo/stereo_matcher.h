#pragma once

#include <memory>

#include <opencv2/core.hpp>

#include "cbmv_stereo/export.h"
#include "cbmv_stereo/forest.h"
#include "cbmv_stereo/options.h"
#include "cbmv_stereo/stereo_result.h"
#include "cbmv_stereo/vertical_offset.h"

namespace cbmv {

/// The whole method on rectified pairs: the one class that nodelet, tools and tests call.
///
/// Holds the buffers of a frame, so one object serves one frame at a time; use one object per
/// thread. Several can live side by side. Results depend on the images, options, forest and
/// rectification model only, not on earlier frames nor on the number of threads. It works on
/// options.threads threads of oneTBB: those of the task arena that it is called in where that has
/// as many, else those of an arena of its own.
class CBMV_API StereoMatcher {
 public:
  /// Throws Error if `options` are inconsistent (correctOptions mends them).
  StereoMatcher(std::shared_ptr<const Forest> forest, const StereoOptions& options);
  ~StereoMatcher();
  StereoMatcher(const StereoMatcher&) = delete;
  StereoMatcher& operator=(const StereoMatcher&) = delete;

  const StereoOptions& options() const;
  /// From the next frame on. Throws Error as the constructor does and then changes nothing.
  void setOptions(const StereoOptions& options);

  /// With an automatic range, each pair has its own: result.range.
  ///
  /// One pair by itself: the vertical offset is estimated from this pair (if switched on), removed,
  /// and the pair matched. Both images CV_8UC1 of the same size, not empty, and not so large that
  /// they need more memory than options.max_memory_mb; throws Error otherwise.
  StereoResult match(const cv::Mat& left, const cv::Mat& right);

  /// A frame of a stream: the vertical offset is given (RectificationTracker estimates it in the
  /// background).
  StereoResult match(const cv::Mat& left, const cv::Mat& right, const VerticalOffset& offset);

  /// The same into the maps of `result`, whose memory is reused where the size fits: from the
  /// second frame of one size and one set of options on, no memory is allocated but for the tasks
  /// of oneTBB. Maps that share their memory with those of `result` change, too; the images must
  /// not.
  void match(const cv::Mat& left, const cv::Mat& right, const VerticalOffset& offset,
             StereoResult& result);

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace cbmv
