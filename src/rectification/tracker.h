#pragma once

#include <condition_variable>
#include <memory>
#include <mutex>

#include <opencv2/core.hpp>

#include "cbmv_stereo/vertical_offset.h"

namespace cbmv {

template <typename Frame>
class FrameWorker;

/// Follows the residual vertical offset of a stream of pairs without delaying it. Estimates run on
/// one background thread, which the first estimate starts. Thread-safe: all functions may be called
/// from any thread.
class RectificationTracker {
 public:
  explicit RectificationTracker(const RectificationOptions& options);

  /// Waits until a running estimate has finished.
  ~RectificationTracker();

  RectificationTracker(const RectificationTracker&) = delete;
  RectificationTracker& operator=(const RectificationTracker&) = delete;

  /// Returns the current model, which is zero before the first estimate. Starts an estimate on
  /// copies of the images if none is running and the last one started at least options.interval_s
  /// before `now_s`. `now_s` is in seconds of any clock; a clock that jumps back starts an
  /// estimate. A change of the image size resets the tracker. Throws Error if the images differ in
  /// size or are not CV_8UC1.
  VerticalOffset update(const cv::Mat& left, const cv::Mat& right, const DisparityRange& range,
                        double now_s);

  /// The newest measurement, not smoothed, with the `now_s` of its pair. A pair that cannot be
  /// measured does not change it. matches = 0 before the first measurement.
  struct Measurement : VerticalOffsetMeasurement {
    double time_s = 0.0;
  };
  Measurement measurement() const;

  /// Waits until no estimate is running.
  void waitForEstimate() const;

  /// Resets to the zero model. The result of a running estimate is dropped. The next pair starts an
  /// estimate.
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
  mutable std::mutex mutex_;                  ///< guards all members below
  mutable std::condition_variable finished_;  ///< signaled when an estimate finishes
  bool is_running_ = false;
  bool has_started_ = false;
  double last_start_s_ = 0.0;
  int generation_ = 0;  ///< counts resets; identifies results from before a reset
  cv::Size size_;
  VerticalOffset model_;
  Measurement measurement_;
  /// Last member: destroyed before the members that it uses.
  std::unique_ptr<FrameWorker<Pair>> worker_;
};

}  // namespace cbmv
