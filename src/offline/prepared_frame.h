#pragma once

#include "offline/frame_loader.h"
#include "pipeline/frame_processor.h"

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
  PreparedPair pair;
};

/// By several threads at once. Throws InputError if the messages do not fit.
PreparedFrame prepareFrame(LoadedFrame loaded, const StereoTopics& topics, RectifiedBy rectified_by,
                           bool allow_different_frame_ids, const FrameProcessor& processor);

}  // namespace cbmv
