#pragma once

#include <opencv2/core.hpp>

#include "search/range_finder.h"
#include "search/range_tracker.h"

#include "cbmv_stereo/disparity_range.h"
#include "cbmv_stereo/gray_pair.h"

namespace cbmv {

/// Says which disparities are searched where the range is automatic. One pair at a time.
class RangeSource {
 public:
  virtual ~RangeSource() = default;
  /// The range begins at `min_disparity`; RangeFinder::defaultRange where none is found.
  virtual DisparityRange rangeOf(const GrayPair& images, int min_disparity) = 0;
};

/// Each pair has its own range: results do not depend on earlier pairs.
class OwnRange : public RangeSource {
 public:
  DisparityRange rangeOf(const GrayPair& images, int min_disparity) override;

 private:
  RangeFinder finder_;
};

/// The range of a live stream, followed by RangeTracker. Begins anew when the size of the images or
/// `min_disparity` changes.
class FollowedRange : public RangeSource {
 public:
  /// One of so many pairs is measured, and so is the first: the others cost nothing.
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
