#include "cbmv_stereo/matching/matcher_set.h"

#include "cbmv_stereo/matching/padded_image.h"

namespace cbmv {

void MatcherCosts::resize(int width, int disparities, const MatcherSelection& used) {
  if (used[kCensus]) {
    census.resize(width, disparities);
  }
  if (used[kNcc]) {
    ncc.resize(width, disparities);
  }
  if (used[kZeroMeanSad]) {
    zero_mean_sad.resize(width, disparities);
  }
  if (used[kSobelSad]) {
    sobel_sad.resize(width, disparities);
  }
}

void MatcherSet::Scratch::resize(int width) {
  ncc.resize(width);
  zero_mean_sad.resize(width);
  sobel_sad.resize(width);
}

void MatcherSet::prepare(const cv::Mat& left, const cv::Mat& right, const MatcherSelection& used) {
  padImage(left, padded_left_);
  padImage(right, padded_right_);
  if (used[kCensus]) {
    census_.prepare(padded_left_, padded_right_);
  }
  if (used[kNcc]) {
    ncc_.prepare(padded_left_, padded_right_);
  }
  if (used[kZeroMeanSad]) {
    zero_mean_sad_.prepare(padded_left_, padded_right_);
  }
  if (used[kSobelSad]) {
    sobel_sad_.prepare(padded_left_, padded_right_);
  }
}

void MatcherSet::computeRow(int y, const DisparityRange& range, const MatcherSelection& used,
                            Scratch& scratch, MatcherCosts& costs,
                            const RowSpans* spans) const {
  if (used[kCensus]) {
    census_.computeRow(y, range, costs.census, spans);
  }
  if (used[kNcc]) {
    ncc_.computeRow(y, range, scratch.ncc, costs.ncc, spans);
  }
  if (used[kZeroMeanSad]) {
    zero_mean_sad_.computeRow(y, range, scratch.zero_mean_sad, costs.zero_mean_sad, spans);
  }
  if (used[kSobelSad]) {
    sobel_sad_.computeRow(y, range, scratch.sobel_sad, costs.sobel_sad, spans);
  }
}

}  // namespace cbmv
