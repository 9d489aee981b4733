#pragma once

#include <optional>

#include "rectification/tracker.h"

#include "cbmv_stereo/disparity_range.h"
#include "cbmv_stereo/gray_pair.h"
#include "cbmv_stereo/vertical_offset.h"

namespace cbmv {

/// The measured residual vertical offset of a stream or a pair.
struct RectificationState {
  bool is_watched = false;                ///< false: nothing measures it
  VerticalOffsetMeasurement measurement;  ///< the newest; matches = 0: none yet
  double age_s = 0;                       ///< time since the measured pair arrived
};

/// Gives the rectification correction that is applied to a pair before matching. Processes one pair
/// at a time.
class OffsetSource {
 public:
  virtual ~OffsetSource() = default;
  /// `range` and `options` are those used for matching the pair.
  virtual VerticalOffset offsetOf(const GrayPair& images, const DisparityRange& range,
                                  const RectificationOptions& options) = 0;
  /// The state after the newest pair.
  virtual RectificationState state() const { return {}; }
};

/// A given offset, for example from a pair of the same second.
class GivenOffset : public OffsetSource {
 public:
  explicit GivenOffset(const VerticalOffset& offset) : offset_(offset) {}
  VerticalOffset offsetOf(const GrayPair& images, const DisparityRange& range,
                          const RectificationOptions& options) override;

 private:
  VerticalOffset offset_;
};

/// Estimates the offset from each pair. Zero if options.enabled is false.
class OwnOffset : public OffsetSource {
 public:
  VerticalOffset offsetOf(const GrayPair& images, const DisparityRange& range,
                          const RectificationOptions& options) override;
};

/// Offset of a live stream, which a RectificationTracker follows in the background. Starts again
/// when the options or the image size change.
class FollowedOffset : public OffsetSource {
 public:
  VerticalOffset offsetOf(const GrayPair& images, const DisparityRange& range,
                          const RectificationOptions& options) override;
  RectificationState state() const override { return state_; }

 private:
  RectificationOptions options_;
  std::optional<RectificationTracker> tracker_;
  RectificationState state_;
};

}  // namespace cbmv
