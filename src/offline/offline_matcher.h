#pragma once

#include <memory>

#include "offline/frame_loader.h"
#include "ros/stereo_processor.h"

namespace cbmv {

/// How frames are processed.
struct MatchingOptions {
  StereoOptions stereo;
  float min_confidence = 0;
  bool allow_different_frame_ids = true;
};

/// A frame that only waits for the matcher.
struct PreparedFrame {
  LoadedFrame loaded;
  GreyPair images;
  StereoGeometry geometry;
};

/// What StereoProcessor does, but with the vertical offset given: what StereoProcessor follows in
/// the background depends on the time.
class OfflineMatcher {
 public:
  /// Throws Error if the options are inconsistent.
  OfflineMatcher(std::shared_ptr<const Forest> forest, const MatchingOptions& options);

  /// Everything before the matching; by several threads at once. Throws InputError if the messages
  /// do not fit.
  PreparedFrame prepare(LoadedFrame loaded, const StereoTopics& topics) const;

  /// Of the pair by itself; by several threads at once.
  VerticalOffset estimateOffset(const PreparedFrame& frame) const;

  /// One frame at a time. Throws InputError if the images are too large.
  ProcessedFrame match(const PreparedFrame& frame, const VerticalOffset& offset);

 private:
  void adaptTo(cv::Size image_size);

  const MatchingOptions options_;  ///< as asked for; the matcher's have the range clipped
  StereoMatcher matcher_;
  cv::Size adapted_size_;
};

/// Of the left image, CV_8UC3 blue, green, red: of the colour image where there is one that can be
/// used, else grey.
cv::Mat colorOf(const PreparedFrame& frame, const std::string& color_topic);

}  // namespace cbmv
