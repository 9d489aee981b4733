#include "rectification/offset_source.h"

#include <chrono>

namespace cbmv {
namespace {

double steadyNow() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

VerticalOffset GivenOffset::offsetOf(const GrayPair& /*images*/, const DisparityRange& /*range*/,
                                     const RectificationOptions& /*options*/) {
  return offset_;
}

VerticalOffset OwnOffset::offsetOf(const GrayPair& images, const DisparityRange& range,
                                   const RectificationOptions& options) {
  return estimateVerticalOffset(images.left, images.right, range, options);
}

VerticalOffset FollowedOffset::offsetOf(const GrayPair& images, const DisparityRange& range,
                                        const RectificationOptions& options) {
  if (!tracker_ || options != options_) {
    tracker_.emplace(options);
    options_ = options;
  }
  const double now_s = steadyNow();
  const VerticalOffset offset = tracker_->update(images.left, images.right, range, now_s);
  const auto measurement = tracker_->measurement();
  state_ = {options.enabled, measurement, now_s - measurement.time_s};
  return offset;
}

}  // namespace cbmv
