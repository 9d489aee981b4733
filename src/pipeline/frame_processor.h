#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "forest/forest.h"
#include "input/stereo_input.h"
#include "rectification/offset_source.h"
#include "search/range_source.h"

#include "cbmv_stereo/stereo_matcher.h"

namespace cbmv {

class ThreadLimit;

/// A pair that is ready for matching.
struct PreparedPair {
  GrayPair images;
  StereoGeometry geometry;  ///< all 0 without calibration
  InputNames names;
  std::vector<std::string> warnings;  ///< about input and calibration
};

/// Result for one pair.
struct ProcessedFrame {
  cv::Mat left_gray;        ///< CV_8UC1; may share the memory of the input
  StereoGeometry geometry;  ///< all 0 without calibration
  StereoResult result;
  bool range_is_automatic = false;  ///< result.range was found in the images
  double disparity_step_px = 0;     ///< see disparityStep
  RectificationState rectification;
  std::vector<std::string> warnings;  ///< about input and calibration
  /// One message if the requested range was clipped, otherwise empty.
  std::string range_correction;
};

/// Computes disparities and geometry from a pair and its calibration. Node, bag tool and command
/// line all use it. Calibration, range and memory are checked whenever the calibration, the image
/// size or the options change.
class FrameProcessor {
 public:
  /// Throws Error if the options are inconsistent.
  FrameProcessor(std::shared_ptr<const Forest> forest, const StereoOptions& options);

  ~FrameProcessor();
  FrameProcessor(const FrameProcessor&) = delete;
  FrameProcessor& operator=(const FrameProcessor&) = delete;

  /// Applies from the next pair on. May be called while a pair is processed. The options must be
  /// consistent (correctOptions).
  void setOptions(const StereoOptions& options);

  /// From the next pair on, pixels with a lower confidence, in [0, 1], have no disparity. The
  /// confidence map does not change. May be called while a pair is processed.
  void setMinConfidence(float min_confidence) { min_confidence_ = min_confidence; }

  /// Runs all steps before matching. Thread-safe. Throws InputError with the name of the input if
  /// the images or the calibration cannot be used.
  PreparedPair prepare(const StereoInput& input) const;

  /// The disparity range for matching the pair. An automatic range is found from this pair.
  /// Thread-safe. Throws InputError if no disparity fits the images.
  DisparityRange rangeOf(const PreparedPair& pair) const;

  /// The rectification correction estimated from this pair, with the options of the constructor or
  /// of the last setOptions. Thread-safe. Throws InputError if no disparity fits the images.
  VerticalOffset estimateOffset(const PreparedPair& pair) const;

  /// The same as measured, also if it is too small for a correction.
  VerticalOffsetMeasurement measureOffset(const PreparedPair& pair) const;

  /// Matches one pair at a time. An automatic range is found from this pair. Throws InputError if
  /// the images are too large or no disparity fits them.
  ProcessedFrame match(const PreparedPair& pair, OffsetSource& offset);

  /// The same, with an automatic range from `ranges`.
  ProcessedFrame match(const PreparedPair& pair, OffsetSource& offset, RangeSource& ranges);

 private:
  using Check = std::shared_ptr<const CalibrationCheck>;
  struct CheckedCameras {
    StereoCameras cameras;
    cv::Size image_size;
    RectifiedBy rectified_by = RectifiedBy::kOthers;
    Check check;
  };

  Check checkCameras(const StereoInput& input) const;
  StereoOptions wantedOptions() const;
  void takeNewOptions();
  void adaptTo(const PreparedPair& pair, RangeSource& ranges);
  void setOptionsFor(cv::Size image_size, const StereoOptions& wanted,
                     const std::string& image_name);

  StereoMatcher matcher_;
  OwnRange own_range_;
  bool range_is_automatic_ = false;
  std::unique_ptr<ThreadLimit> threads_;  ///< threads for finding the range
  std::optional<cv::Size> adapted_size_;  ///< empty: the matcher does not have options_ yet
  DisparityRange adapted_range_;          ///< before clipping
  std::string range_correction_;
  std::atomic<float> min_confidence_{0};

  mutable std::mutex options_mutex_;  ///< guards the next two members
  StereoOptions options_;             ///< as requested; the matcher has the clipped range
  bool options_are_new_ = false;

  mutable std::mutex checked_mutex_;
  mutable CheckedCameras checked_;  ///< the newest
};

/// Smallest step between two disparities with these `options`, in px: 1 for whole-pixel
/// disparities, otherwise the spacing of float at the largest disparity of `range`.
double disparityStep(const DisparityRange& range, const RefinementOptions& options);

/// Formats a range for users as "0 ... 63 px".
std::string describeRange(const DisparityRange& range);

/// The disparities of `range` that have a match in images of this width. `range` must not be
/// automatic. Throws InputError if there are none.
DisparityRange clipRange(const DisparityRange& range, int image_width);

/// The disparity range for matching this pair: found in the images if `wanted` is automatic, and
/// clipped to the images. Throws InputError if no disparity fits the images.
DisparityRange rangeOfPair(const GrayPair& images, const DisparityRange& wanted);

/// The options `wanted` with the range clipped to images of this size. The range must not be
/// automatic. Throws InputError if no disparity fits the images, or if they need more memory than
/// max_memory_mb or than the machine has. The text begins with `image_name`.
StereoOptions optionsFor(cv::Size image_size, const StereoOptions& wanted,
                         const std::string& image_name);

}  // namespace cbmv
