#pragma once

#include <optional>

#include "rectification/tracker.h"

#include "cbmv_stereo/disparity_range.h"
#include "cbmv_stereo/gray_pair.h"
#include "cbmv_stereo/vertical_offset.h"

namespace cbmv {

/// What is known of how far the rows of the images are apart.
struct RectificationState {
  bool is_watched = false;                ///< false: nothing measures it
  VerticalOffsetMeasurement measurement;  ///< the newest; matches = 0: none yet
  double age_s = 0;                       ///< since the pair that was measured came
};

/// Says which vertical offset is removed from a pair before it is matched. One pair at a time.
class OffsetSource {
 public:
  virtual ~OffsetSource() = default;
  /// `range` and `options` are those that the pair is matched with.
  virtual VerticalOffset offsetOf(const GrayPair& images, const DisparityRange& range,
                                  const RectificationOptions& options) = 0;
  /// As of the newest pair.
  virtual RectificationState state() const { return {}; }
};

/// The offset is known, for example from a pair of the same second.
class GivenOffset : public OffsetSource {
 public:
  explicit GivenOffset(const VerticalOffset& offset) : offset_(offset) {}
  VerticalOffset offsetOf(const GrayPair& images, const DisparityRange& range,
                          const RectificationOptions& options) override;

 private:
  VerticalOffset offset_;
};

/// The offset is estimated from each pair itself; zero where options.enabled is false.
class OwnOffset : public OffsetSource {
 public:
  VerticalOffset offsetOf(const GrayPair& images, const DisparityRange& range,
                          const RectificationOptions& options) override;
};

/// The offset of a live stream, which a RectificationTracker follows in the background. Begins anew
/// when the options or the size of the images change.
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
