#include "ros/stereo_processor.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "ros/image_conversion.h"

#include "cbmv_stereo/pipeline/machine_memory.h"
#include "cbmv_stereo/pipeline/memory.h"

namespace cbmv {
namespace {

double steadyNow() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

std::string rangeText(const DisparityRange& range) {
  return std::to_string(range.min) + " ... " + std::to_string(range.max()) + " px";
}

/// The kernel ends a process that takes more than there is.
void requireMachineHas(double required_mb, const std::string& images) {
  const double present_mb = machineMemoryMb();
  if (required_mb > present_mb) {
    throw InputError(InputFault::kMemory,
                     images + " need " + std::to_string(std::llround(required_mb)) +
                         " MB, but the machine has " + std::to_string(std::llround(present_mb)) +
                         "; lower disparity_range or take smaller images");
  }
}

}  // namespace

DisparityRange clipRange(const DisparityRange& range, int image_width) {
  const int lowest = std::max(range.min, 1 - image_width);
  const int highest = std::min(range.max(), image_width - 1);
  if (lowest > highest) {
    throw InputError(InputFault::kDisparityRange,
                     "the disparities " + rangeText(range) + " lie outside of images " +
                         std::to_string(image_width) +
                         " px wide; min_disparity and disparity_range have to leave some inside");
  }
  return {lowest, highest - lowest + 1};
}

StereoOptions optionsFor(cv::Size image_size, const StereoOptions& wanted,
                         const std::string& prefix) {
  StereoOptions options = wanted;
  options.range = clipRange(wanted.range, image_size.width);
  const std::string refusal = memoryRefusal(image_size, options);
  if (!refusal.empty()) {
    throw InputError(InputFault::kMemory, prefix + refusal);
  }
  requireMachineHas(requiredMemoryMb(image_size, options), prefix + sizeText(image_size));
  return options;
}

StereoProcessor::StereoProcessor(std::shared_ptr<const Forest> forest, const StereoOptions& options,
                                 bool allow_different_frame_ids)
    : allow_different_frame_ids_(allow_different_frame_ids),
      matcher_(std::move(forest), options),
      options_(options) {}

void StereoProcessor::setOptions(const StereoOptions& options) {
  const std::lock_guard<std::mutex> lock(new_options_mutex_);
  new_options_ = options;
}

ProcessedFrame StereoProcessor::process(const StereoMessages& messages,
                                        const StereoTopics& topics) {
  takeNewOptions();
  const GreyPair images = toGreyPair(messages, topics, allow_different_frame_ids_);
  ProcessedFrame frame;
  frame.geometry =
      toGeometry(*messages.left_info, *messages.right_info, images.left.size(), topics);
  if (adapted_size_ != images.left.size()) {
    adaptTo(images.left.size(), topics.left_image);
  }
  const StereoOptions& options = matcher_.options();
  followRectification(options.rectification);
  const double now_s = steadyNow();
  const VerticalOffset offset = tracker_->update(images.left, images.right, options.range, now_s);
  frame.rectification = rectificationState(now_s);
  frame.result = matcher_.match(images.left, images.right, offset);
  frame.result.disparity.setTo(frame.result.range.invalid(),
                               frame.result.confidence < min_confidence_.load());
  frame.left_grey = images.left;
  frame.disparity_step_px = disparityStep(options.range, options.refinement);
  frame.range_correction = range_correction_;
  frame.memory_mb = memory_mb_;
  return frame;
}

void StereoProcessor::takeNewOptions() {
  const std::lock_guard<std::mutex> lock(new_options_mutex_);
  if (new_options_) {
    options_ = *std::exchange(new_options_, std::nullopt);
    adapted_size_.reset();
  }
}

void StereoProcessor::adaptTo(cv::Size image_size, const std::string& image_topic) {
  const StereoOptions options = optionsFor(image_size, options_, image_topic + ": ");
  range_correction_.clear();
  if (options.range.count != options_.range.count) {
    range_correction_ = "disparity_range is " + std::to_string(options_.range.count) +
                        ", but the images on " + image_topic + " are only " +
                        std::to_string(image_size.width) + " px wide: the disparities " +
                        rangeText(options.range) + " are used";
  }
  matcher_.setOptions(options);
  memory_mb_ = requiredMemoryMb(image_size, options);
  adapted_size_ = image_size;
}

void StereoProcessor::followRectification(const RectificationOptions& options) {
  if (!tracker_ || options != tracker_options_) {
    tracker_.emplace(options);
    tracker_options_ = options;
  }
}

RectificationState StereoProcessor::rectificationState(double now_s) const {
  const auto measurement = tracker_->measurement();
  return {tracker_options_.enabled, measurement, now_s - measurement.time_s};
}

}  // namespace cbmv
