#pragma once

#include <condition_variable>
#include <memory>
#include <mutex>

#include <opencv2/core.hpp>

#include "cbmv_stereo/vertical_offset.h"

namespace cbmv {

template <typename Frame>
class FrameWorker;

/// Follows the vertical offset of a stream of pairs without holding the stream up: estimates run on
/// one background thread, which the first one starts. All functions may be called from any thread.
class RectificationTracker {
 public:
  explicit RectificationTracker(const RectificationOptions& options);

  /// Waits for the estimate under way, if any.
  ~RectificationTracker();

  RectificationTracker(const RectificationTracker&) = delete;
  RectificationTracker& operator=(const RectificationTracker&) = delete;

  /// Returns the model as it is now, zero until the first estimate is there. Starts an estimate on
  /// copies of the images when none is under way and the last one was started at least
  /// options.interval_s before `now_s` (seconds of any clock; a clock that jumps back counts as
  /// elapsed). Images of another size than before reset the tracker.
  /// Throws Error when the images differ in size or are not CV_8UC1.
  VerticalOffset update(const cv::Mat& left, const cv::Mat& right, const DisparityRange& range,
                        double now_s);

  /// The newest measurement, not smoothed, and the `now_s` of the pair that it was taken from. A
  /// pair that could not be measured leaves the one before; matches = 0 before the first one.
  struct Measurement : VerticalOffsetMeasurement {
    double time_s = 0.0;
  };
  Measurement measurement() const;

  /// Waits until no estimate is under way.
  void waitForEstimate() const;

  /// Back to the zero model; the estimate under way is dropped, the next pair starts one.
  void reset();

 private:
  struct Pair {
    cv::Mat left, right;
    DisparityRange range;
    double time_s = 0.0;
    int generation = 0;
  };

  void resetLocked();
  void start(Pair pair);
  void estimate(const Pair& pair);
  void finish(const Measurement& measurement, int generation);
  void blend(const VerticalOffset& estimate);

  const RectificationOptions options_;
  mutable std::mutex mutex_;                  ///< guards all below
  mutable std::condition_variable finished_;  ///< an estimate
  bool is_running_ = false;
  bool has_started_ = false;
  double last_start_s_ = 0.0;
  int generation_ = 0;  ///< counts resets; tells results of before a reset
  cv::Size size_;
  VerticalOffset model_;
  Measurement measurement_;
  std::unique_ptr<FrameWorker<Pair>> worker_;  ///< the last member: ends before the others go
};

}  // namespace cbmv
