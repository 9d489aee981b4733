#pragma once

#include <optional>

#include "cbmv_stereo/disparity_range.h"

namespace cbmv {

/// The disparity range of a stream: it widens at once, and shrinks only when less has been enough
/// for long, so that memory is not taken anew for every frame.
class RangeTracker {
 public:
  /// So many measurements in a row have to need at most 3/4 of the range before it shrinks to the
  /// widest of them.
  static constexpr int kMeasurementsToShrink = 24;

  /// Takes what RangeFinder has found in the newest pair. Another lowest disparity than before
  /// begins anew.
  void add(const DisparityRange& found);

  /// Nothing before the first measurement.
  const std::optional<DisparityRange>& range() const { return range_; }

 private:
  void use(const DisparityRange& range);

  std::optional<DisparityRange> range_;
  int smaller_ = 0;          ///< measurements in a row that need clearly less
  int largest_of_them_ = 0;  ///< number of disparities
};

}  // namespace cbmv
