#include "offline/double_rectification.h"

#include <algorithm>
#include <array>
#include <cstdio>

#include "offline/frame_loader.h"
#include "pipeline/frame_processor.h"
#include "ros/image_conversion.h"

#include "cbmv_stereo/vertical_offset.h"

namespace cbmv {
namespace {

// Rows of a rectified pair are usually closer than kRectifiedPx, rows of a raw pair are not.
// kNoticeablePx is above the noise of subpixel matching.
constexpr double kRectifiedPx = 1.0;
constexpr double kNoticeablePx = 0.2;
constexpr double kClearlyWorse = 2.0;

VerticalOffsetMeasurement measure(const CameraTopics& topics, const PlannedFrame& frame,
                                  StereoOptions options) {
  FrameLoader loader(topics, false);
  const LoadedFrame loaded = loader.load(frame);
  const GrayPair pair = toGrayPair(toStereoInput(loaded.messages, loader.topicNames(), true));
  options.rectification.enabled = true;
  return measureVerticalOffset(pair.left, pair.right, rangeOfPair(pair, options.range),
                               options.rectification);
}

}  // namespace

std::string doubleRectificationWarning(const CameraTopics& topics, const PlannedFrame& frame,
                                       const StereoOptions& options) {
  CameraTopics as_they_are = topics;
  as_they_are.left.raw = as_they_are.right.raw = false;
  try {
    const VerticalOffsetMeasurement before = measure(as_they_are, frame, options);
    const VerticalOffsetMeasurement after = measure(topics, frame, options);
    const bool is_known = after.model.matches > 0;
    if (before.model.matches == 0 ||
        (is_known &&
         after.rms_before_px < std::max(kNoticeablePx, kClearlyWorse * before.rms_before_px))) {
      return {};
    }
    const char* const cause =
        before.rms_before_px > kRectifiedPx
            ? "The calibration does not match the images: R is inverted or belongs to another "
              "camera or rig. Correct R, or calibrate the cameras again."
            : "The images are probably rectified already; use --rectified yes.";
    std::array<char, 64> apart{};
    std::snprintf(apart.data(), apart.size(), is_known ? "%.2f px" : "too large to measure",
                  after.rms_before_px);
    std::array<char, 400> text{};
    std::snprintf(text.data(), text.size(),
                  ": the vertical offset of the pair is %s after rectification, %.2f px before. %s",
                  apart.data(), before.rms_before_px, cause);
    return topics.left.name + " and " + topics.right.name + text.data();
  } catch (const InputError&) {
    return {};  // reported when the frame itself is processed
  }
}

std::string verticalOffsetWarning(const CameraTopics& topics, const PlannedFrame& frame,
                                  const StereoOptions& options) {
  try {
    const VerticalOffsetMeasurement rows = measure(topics, frame, options);
    if (rows.model.matches == 0 || rows.rms_before_px <= kRectifiedPx) {
      return {};
    }
    std::array<char, 300> text{};
    std::snprintf(text.data(), text.size(),
                  ": the vertical offset of the pair is %.2f px, expected at most %.2f px. It is "
                  "corrected, but depth is probably wrong. %s",
                  rows.rms_before_px, kRectifiedPx,
                  topics.left.raw
                      ? "Calibrate the cameras."
                      : "Use --rectified no for raw images, otherwise calibrate the cameras.");
    return topics.left.name + " and " + topics.right.name + text.data();
  } catch (const InputError&) {
    return {};  // reported when the frame itself is processed
  }
}

}  // namespace cbmv
