#pragma once

#include "offline/frame_loader.h"
#include "pipeline/frame_processor.h"

namespace cbmv {

/// Settings for processing frames.
struct MatchingOptions {
  StereoOptions stereo;
  float min_confidence = 0;
  bool allow_different_frame_ids = true;
};

/// A frame that is ready for the matcher.
struct PreparedFrame {
  LoadedFrame loaded;
  PreparedPair pair;
};

/// Thread-safe. Throws InputError if the messages are inconsistent.
PreparedFrame prepareFrame(LoadedFrame loaded, const StereoTopics& topics, RectifiedBy rectified_by,
                           bool allow_different_frame_ids, const FrameProcessor& processor);

}  // namespace cbmv
