#include "search/range_source.h"

namespace cbmv {

DisparityRange OwnRange::rangeOf(const GrayPair& images, int min_disparity) {
  return finder_.find(images.left, images.right, min_disparity)
      .value_or(RangeFinder::defaultRange(min_disparity, images.left.cols));
}

DisparityRange FollowedRange::rangeOf(const GrayPair& images, int min_disparity) {
  if (images.left.size() != size_ || min_disparity != min_disparity_) {
    size_ = images.left.size();
    min_disparity_ = min_disparity;
    tracker_ = {};
    pairs_to_measurement_ = 0;
  }
  if (pairs_to_measurement_ == 0) {
    pairs_to_measurement_ = kPeriod;
    if (const auto found = finder_.find(images.left, images.right, min_disparity)) {
      tracker_.add(*found);
    }
  }
  --pairs_to_measurement_;
  return tracker_.range().value_or(RangeFinder::defaultRange(min_disparity, images.left.cols));
}

}  // namespace cbmv
