#pragma once

#include <opencv2/core.hpp>

#include "search/range_finder.h"
#include "search/range_tracker.h"

#include "cbmv_stereo/disparity_range.h"
#include "cbmv_stereo/gray_pair.h"

namespace cbmv {

/// Gives the disparity range if it is automatic. Processes one pair at a time.
class RangeSource {
 public:
  virtual ~RangeSource() = default;
  /// The range begins at `min_disparity`. RangeFinder::defaultRange if none is found.
  virtual DisparityRange rangeOf(const GrayPair& images, int min_disparity) = 0;
};

/// Finds the range of each pair separately. Results do not depend on earlier pairs.
class OwnRange : public RangeSource {
 public:
  DisparityRange rangeOf(const GrayPair& images, int min_disparity) override;

 private:
  RangeFinder finder_;
};

/// Follows the range of a live stream with a RangeTracker. Starts again when the image size or
/// `min_disparity` changes.
class FollowedRange : public RangeSource {
 public:
  /// Every kPeriod-th pair is measured, beginning with the first. The others cost nothing.
  static constexpr int kPeriod = 5;

  DisparityRange rangeOf(const GrayPair& images, int min_disparity) override;

 private:
  RangeFinder finder_;
  RangeTracker tracker_;
  cv::Size size_;
  int min_disparity_ = 0;
  int pairs_to_measurement_ = 0;
};

}  // namespace cbmv
