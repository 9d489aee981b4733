#pragma once

#include <optional>

#include "cbmv_stereo/disparity_range.h"

namespace cbmv {

/// The disparity range of a stream. It grows at once, and shrinks only after a long time with a
/// smaller need, so that memory is not reallocated for every frame.
class RangeTracker {
 public:
  /// The range shrinks if this many consecutive measurements need at most 3/4 of it. It shrinks to
  /// the largest of them.
  static constexpr int kMeasurementsToShrink = 24;

  /// Adds the result of RangeFinder for the newest pair. A change of the lowest disparity resets
  /// the tracker.
  void add(const DisparityRange& found);

  /// Empty before the first measurement.
  const std::optional<DisparityRange>& range() const { return range_; }

 private:
  void use(const DisparityRange& range);

  std::optional<DisparityRange> range_;
  int smaller_ = 0;          ///< consecutive measurements that need clearly less
  int largest_of_them_ = 0;  ///< the largest number of disparities of these measurements
};

}  // namespace cbmv
