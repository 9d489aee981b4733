#include "search/range_tracker.h"

#include <algorithm>

namespace cbmv {

void RangeTracker::add(const DisparityRange& found) {
  if (!range_ || found.min != range_->min || found.count > range_->count) {
    use(found);
    return;
  }
  if (4 * found.count > 3 * range_->count) {
    use(*range_);
    return;
  }
  largest_of_them_ = std::max(largest_of_them_, found.count);
  if (++smaller_ == kMeasurementsToShrink) {
    use({found.min, largest_of_them_});
  }
}

void RangeTracker::use(const DisparityRange& range) {
  range_ = range;
  smaller_ = 0;
  largest_of_them_ = 0;
}

}  // namespace cbmv
