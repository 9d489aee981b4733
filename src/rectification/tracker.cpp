#include "rectification/tracker.h"

#include <exception>
#include <utility>

#include "base/frame_worker.h"
#include "rectification/sparse_matches.h"

namespace cbmv {

RectificationTracker::RectificationTracker(const RectificationOptions& options)
    : options_(options) {}

RectificationTracker::~RectificationTracker() = default;

VerticalOffset RectificationTracker::update(const cv::Mat& left, const cv::Mat& right,
                                            const DisparityRange& range, double now_s) {
  requireGrayPair(left, right);
  if (!options_.enabled) {
    return {};
  }
  const std::lock_guard<std::mutex> lock(mutex_);
  if (left.size() != size_) {
    resetLocked();
    size_ = left.size();
  }
  const double elapsed_s = now_s - last_start_s_;
  const bool is_due = !has_started_ || elapsed_s < 0.0 || elapsed_s >= options_.interval_s;
  if (is_due && !is_running_) {
    start({left, right, range, now_s, generation_});
    last_start_s_ = now_s;
    has_started_ = true;
  }
  return model_;
}

RectificationTracker::Measurement RectificationTracker::measurement() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return measurement_;
}

void RectificationTracker::waitForEstimate() const {
  std::unique_lock<std::mutex> lock(mutex_);
  finished_.wait(lock, [this] { return !is_running_; });
}

void RectificationTracker::reset() {
  const std::lock_guard<std::mutex> lock(mutex_);
  resetLocked();
}

void RectificationTracker::resetLocked() {
  model_ = {};
  measurement_ = {};
  has_started_ = false;
  ++generation_;
}

/// Uses one thread for all estimates, because OpenCV keeps 800 bytes for each thread that ever
/// called it.
void RectificationTracker::start(Pair pair) {
  try {
    if (!worker_) {
      worker_ = std::make_unique<FrameWorker<Pair>>([this](const Pair& given) { estimate(given); });
    }
    pair.left = pair.left.clone();
    pair.right = pair.right.clone();
    worker_->submit(std::move(pair));
    // The estimate cannot have finished yet, because finish() needs the mutex.
    is_running_ = true;
  } catch (const std::exception&) {
    return;  // no memory or no thread: the next pair tries again
  }
}

void RectificationTracker::estimate(const Pair& pair) {
  Measurement measurement;
  try {
    measurement = {measureVerticalOffset(pair.left, pair.right, pair.range, options_), pair.time_s};
  } catch (const std::exception&) {
    measurement = {};  // out of memory, for example: the next pair tries again
  }
  finish(measurement, pair.generation);
}

void RectificationTracker::finish(const Measurement& measurement, int generation) {
  const std::lock_guard<std::mutex> lock(mutex_);
  is_running_ = false;
  if (generation == generation_ && measurement.model.matches > 0) {
    measurement_ = measurement;
    blend(toCorrection(measurement, size_, options_));
  }
  finished_.notify_all();
}

void RectificationTracker::blend(const VerticalOffset& estimate) {
  const double share = model_.matches > 0 ? options_.smoothing : 0.0;
  const auto mix = [share](double old_value, double value) {
    return share * old_value + (1.0 - share) * value;
  };
  const VerticalOffset old = model_;
  model_ = estimate;
  model_.offset_px = mix(old.offset_px, estimate.offset_px);
  model_.slope_x = mix(old.slope_x, estimate.slope_x);
  model_.slope_y = mix(old.slope_y, estimate.slope_y);
  model_.twist = mix(old.twist, estimate.twist);
  model_.curvature_x = mix(old.curvature_x, estimate.curvature_x);
  model_.curvature_y = mix(old.curvature_y, estimate.curvature_y);
  if (model_.rootMeanSquare(size_) < options_.min_correction_px) {
    model_.clearCorrection();
  }
}

}  // namespace cbmv
