#include "pipeline/frame_processor.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/thread_limit.h"
#include "pipeline/machine_memory.h"

namespace cbmv {
namespace {

std::string prefixOf(const std::string& image_name) {
  return image_name.empty() ? "" : image_name + ": ";
}

}  // namespace

std::string describeRange(const DisparityRange& range) {
  return std::to_string(range.min) + " ... " + std::to_string(range.max()) + " px";
}

double disparityStep(const DisparityRange& range, const RefinementOptions& options) {
  if (!options.subpixel && options.bilateral_sigma_px == 0) {
    return 1;
  }
  const auto largest = static_cast<float>(std::max(std::abs(range.min), std::abs(range.max())));
  return std::nextafter(largest, std::numeric_limits<float>::infinity()) - largest;
}

DisparityRange clipRange(const DisparityRange& range, int image_width) {
  const int lowest = std::max(range.min, 1 - image_width);
  const int highest = std::min(range.max(), image_width - 1);
  if (lowest > highest) {
    throw InputError(InputFault::kDisparityRange,
                     "the disparity range " + describeRange(range) +
                         " is outside the images, which are " + std::to_string(image_width) +
                         " px wide. Change min_disparity or disparity_range");
  }
  return {lowest, highest - lowest + 1};
}

DisparityRange rangeOfPair(const GrayPair& images, const DisparityRange& wanted) {
  return clipRange(wanted.isAutomatic() ? OwnRange().rangeOf(images, wanted.min) : wanted,
                   images.left.cols);
}

StereoOptions optionsFor(cv::Size image_size, const StereoOptions& wanted,
                         const std::string& image_name) {
  StereoOptions options = wanted;
  options.range = clipRange(wanted.range, image_size.width);
  try {
    requireMemory(image_size, options);
  } catch (const Error& error) {
    throw InputError(InputFault::kMemory, prefixOf(image_name) + error.what());
  }
  return options;
}

FrameProcessor::FrameProcessor(std::shared_ptr<const Forest> forest, const StereoOptions& options)
    : matcher_(std::move(forest), options),
      threads_(std::make_unique<ThreadLimit>(options.threads)),
      options_(options) {}

FrameProcessor::~FrameProcessor() = default;

void FrameProcessor::setOptions(const StereoOptions& options) {
  const std::lock_guard<std::mutex> lock(options_mutex_);
  options_ = options;
  options_are_new_ = true;
}

PreparedPair FrameProcessor::prepare(const StereoInput& input) const {
  PreparedPair pair;
  pair.names = input.names;
  pair.images = toGrayPair(input);
  pair.warnings = input.warnings;
  if (input.cameras) {
    const auto check = checkCameras(input);
    pair.geometry = requireUsable(*check);
    pair.warnings.insert(pair.warnings.end(), check->warnings.begin(), check->warnings.end());
  }
  return pair;
}

VerticalOffset FrameProcessor::estimateOffset(const PreparedPair& pair) const {
  return toCorrection(measureOffset(pair), pair.images.left.size(), wantedOptions().rectification);
}

VerticalOffsetMeasurement FrameProcessor::measureOffset(const PreparedPair& pair) const {
  return measureVerticalOffset(pair.images.left, pair.images.right, rangeOf(pair),
                               wantedOptions().rectification);
}

DisparityRange FrameProcessor::rangeOf(const PreparedPair& pair) const {
  return rangeOfPair(pair.images, wantedOptions().range);
}

ProcessedFrame FrameProcessor::match(const PreparedPair& pair, OffsetSource& offset) {
  return match(pair, offset, own_range_);
}

ProcessedFrame FrameProcessor::match(const PreparedPair& pair, OffsetSource& offset,
                                     RangeSource& ranges) {
  takeNewOptions();
  adaptTo(pair, ranges);
  const StereoOptions& options = matcher_.options();
  ProcessedFrame frame;
  const VerticalOffset vertical_offset =
      offset.offsetOf(pair.images, options.range, options.rectification);
  try {
    frame.result = matcher_.match(pair.images.left, pair.images.right, vertical_offset);
  } catch (const InputError& error) {
    throw InputError(error.fault(), prefixOf(pair.names.left_image) + error.what());
  }
  frame.rectification = offset.state();
  frame.result.disparity.setTo(frame.result.range.invalid(),
                               frame.result.confidence < min_confidence_.load());
  frame.left_gray = pair.images.left;
  frame.geometry = pair.geometry;
  frame.warnings = pair.warnings;
  frame.range_is_automatic = range_is_automatic_;
  frame.disparity_step_px = disparityStep(options.range, options.refinement);
  frame.range_correction = range_correction_;
  return frame;
}

FrameProcessor::Check FrameProcessor::checkCameras(const StereoInput& input) const {
  const std::lock_guard<std::mutex> lock(checked_mutex_);
  const bool is_known = checked_.check && checked_.image_size == input.left.size() &&
                        checked_.rectified_by == input.rectified_by &&
                        checked_.cameras == *input.cameras;
  if (!is_known) {
    checked_ = {*input.cameras, input.left.size(), input.rectified_by,
                std::make_shared<const CalibrationCheck>(checkCalibration(
                    *input.cameras, input.left.size(), input.names, input.rectified_by))};
  }
  return checked_.check;
}

StereoOptions FrameProcessor::wantedOptions() const {
  const std::lock_guard<std::mutex> lock(options_mutex_);
  return options_;
}

void FrameProcessor::takeNewOptions() {
  const std::lock_guard<std::mutex> lock(options_mutex_);
  if (std::exchange(options_are_new_, false)) {
    adapted_size_.reset();
  }
}

void FrameProcessor::adaptTo(const PreparedPair& pair, RangeSource& ranges) {
  StereoOptions wanted = wantedOptions();
  range_is_automatic_ = wanted.range.isAutomatic();
  if (range_is_automatic_) {
    threads_->set(wanted.threads);
    threads_->run([&] { wanted.range = ranges.rangeOf(pair.images, wanted.range.min); });
  }
  const cv::Size size = pair.images.left.size();
  if (adapted_size_ != size || adapted_range_ != wanted.range) {
    setOptionsFor(size, wanted, pair.names.left_image);
    adapted_range_ = wanted.range;
  }
}

void FrameProcessor::setOptionsFor(cv::Size image_size, const StereoOptions& wanted,
                                   const std::string& image_name) {
  const StereoOptions options = optionsFor(image_size, wanted, image_name);
  range_correction_.clear();
  if (options.range.count != wanted.range.count) {
    range_correction_ = "disparity_range is " + std::to_string(wanted.range.count) +
                        ", but the images on " + image_name + " are only " +
                        std::to_string(image_size.width) + " px wide. The range " +
                        describeRange(options.range) + " is used. Lower disparity_range";
  }
  matcher_.setOptions(options);
  adapted_size_ = image_size;
}

}  // namespace cbmv
