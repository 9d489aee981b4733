#include "cbmv_stereo/matching/matcher_set.h"

#include "cbmv_stereo/matching/padded_image.h"

namespace cbmv {

void MatcherSet::prepare(const cv::Mat& left, const cv::Mat& right) {
  padImage(left, padded_left_);
  padImage(right, padded_right_);
  census_.prepare(padded_left_, padded_right_);
  ncc_.prepare(padded_left_, padded_right_);
  zero_mean_sad_.prepare(padded_left_, padded_right_);
  sobel_sad_.prepare(padded_left_, padded_right_);
}

void MatcherSet::computeRow(int y, const DisparityRange& range, const MatcherSelection& used,
                            Scratch& scratch, MatcherCosts& costs) const {
  if (used[kCensus]) {
    census_.computeRow(y, range, costs.census);
  }
  if (used[kNcc]) {
    ncc_.computeRow(y, range, scratch.ncc, costs.ncc);
  }
  if (used[kZeroMeanSad]) {
    zero_mean_sad_.computeRow(y, range, scratch.zero_mean_sad, costs.zero_mean_sad);
  }
  if (used[kSobelSad]) {
    sobel_sad_.computeRow(y, range, scratch.sobel_sad, costs.sobel_sad);
  }
}

}  // namespace cbmv
