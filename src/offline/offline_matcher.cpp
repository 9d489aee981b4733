#include "offline/offline_matcher.h"

#include <utility>

#include <opencv2/imgproc.hpp>

namespace cbmv {

OfflineMatcher::OfflineMatcher(std::shared_ptr<const Forest> forest, const MatchingOptions& options)
    : options_(options), matcher_(std::move(forest), options.stereo) {}

PreparedFrame OfflineMatcher::prepare(LoadedFrame loaded, const StereoTopics& topics) const {
  PreparedFrame frame;
  frame.loaded = std::move(loaded);
  const StereoMessages& messages = frame.loaded.messages;
  frame.images = toGreyPair(messages, topics, options_.allow_different_frame_ids);
  const cv::Size size = frame.images.left.size();
  frame.geometry = toGeometry(*messages.left_info, *messages.right_info, size, topics);
  return frame;
}

VerticalOffset OfflineMatcher::estimateOffset(const PreparedFrame& frame) const {
  const GreyPair& images = frame.images;
  return estimateVerticalOffset(images.left, images.right,
                                clipRange(options_.stereo.range, images.left.cols),
                                options_.stereo.rectification);
}

ProcessedFrame OfflineMatcher::match(const PreparedFrame& frame, const VerticalOffset& offset) {
  adaptTo(frame.images.left.size());
  ProcessedFrame processed;
  processed.left_grey = frame.images.left;
  processed.geometry = frame.geometry;
  processed.result = matcher_.match(frame.images.left, frame.images.right, offset);
  processed.result.disparity.setTo(processed.result.range.invalid(),
                                   processed.result.confidence < options_.min_confidence);
  const StereoOptions& options = matcher_.options();
  processed.disparity_step_px = disparityStep(options.range, options.refinement);
  return processed;
}

void OfflineMatcher::adaptTo(cv::Size image_size) {
  if (image_size == adapted_size_) {
    return;
  }
  matcher_.setOptions(optionsFor(image_size, options_.stereo));
  adapted_size_ = image_size;
}

cv::Mat colorOf(const PreparedFrame& frame, const std::string& color_topic) {
  if (frame.loaded.color) {
    try {
      return toColor(*frame.loaded.color, color_topic, frame.images.left.size());
    } catch (const InputError&) {  // as with the live node, the cloud stays grey
    }
  }
  cv::Mat grey;
  cv::cvtColor(frame.images.left, grey, cv::COLOR_GRAY2BGR);
  return grey;
}

}  // namespace cbmv
