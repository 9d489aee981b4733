#pragma once

#include <memory>

#include <opencv2/core.hpp>

#include "cbmv_stereo/export.h"
#include "cbmv_stereo/forest.h"
#include "cbmv_stereo/options.h"
#include "cbmv_stereo/stereo_result.h"
#include "cbmv_stereo/vertical_offset.h"

namespace cbmv {

/// The whole method on rectified pairs. Nodelet, tools and tests call this class.
///
/// Thread safety: an object holds the buffers of a frame, so it processes one frame at a time. Use
/// one object per thread. Several objects can exist at the same time. Results depend only on the
/// images, options, forest and rectification model, not on earlier frames or the number of threads.
/// It runs on options.threads threads of oneTBB: in the task arena of the caller if it has that
/// many threads, otherwise in an arena of its own.
class CBMV_API StereoMatcher {
 public:
  /// Throws Error if `options` are inconsistent (correctOptions corrects them).
  StereoMatcher(std::shared_ptr<const Forest> forest, const StereoOptions& options);
  ~StereoMatcher();
  StereoMatcher(const StereoMatcher&) = delete;
  StereoMatcher& operator=(const StereoMatcher&) = delete;

  const StereoOptions& options() const;
  /// Applies from the next frame on. Throws Error as the constructor does, and then changes
  /// nothing.
  void setOptions(const StereoOptions& options);

  /// Matches a single pair. The residual vertical offset is estimated from this pair (if enabled)
  /// and removed before matching. With an automatic range, each pair has its own range
  /// (result.range).
  ///
  /// Both images are CV_8UC1, of the same size and not empty. Throws Error if they are not, or if
  /// they need more memory than options.max_memory_mb.
  StereoResult match(const cv::Mat& left, const cv::Mat& right);

  /// Matches a frame of a stream with a given residual vertical offset (RectificationTracker
  /// estimates it in the background).
  StereoResult match(const cv::Mat& left, const cv::Mat& right, const VerticalOffset& offset);

  /// The same, but writes into the maps of `result`. Their memory is reused where the size fits.
  /// From the second frame with the same size and options on, no memory is allocated except for the
  /// tasks of oneTBB. Maps that share memory with `result` change too. The images must not share
  /// memory with `result`.
  void match(const cv::Mat& left, const cv::Mat& right, const VerticalOffset& offset,
             StereoResult& result);

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace cbmv
