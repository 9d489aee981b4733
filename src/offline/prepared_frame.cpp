#include "offline/prepared_frame.h"

#include <utility>

#include "ros/image_conversion.h"

namespace cbmv {

PreparedFrame prepareFrame(LoadedFrame loaded, const StereoTopics& topics, RectifiedBy rectified_by,
                           bool allow_different_frame_ids, const FrameProcessor& processor) {
  StereoInput input = toStereoInput(loaded.messages, topics, allow_different_frame_ids);
  input.rectified_by = rectified_by;
  input.warnings.insert(input.warnings.end(), loaded.warnings.begin(), loaded.warnings.end());
  PreparedFrame frame;
  frame.loaded = std::move(loaded);
  frame.pair = processor.prepare(input);
  return frame;
}

}  // namespace cbmv
