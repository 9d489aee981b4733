#include "matching/matcher_set.h"

#include "matching/padded_image.h"

namespace cbmv {

void MatcherCosts::resize(std::size_t entries, const MatcherSelection& used) {
  if (used[kCensus]) {
    census.resize(entries);
  }
  if (used[kNcc]) {
    ncc.resize(entries);
  }
  if (used[kZeroMeanSad]) {
    zero_mean_sad.resize(entries);
  }
  if (used[kSobelSad]) {
    sobel_sad.resize(entries);
  }
}

void MatcherSet::Scratch::resize(int width) {
  census.resize(width);
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

void MatcherSet::computeRow(int y, const RowEntries& entries, const MatcherSelection& used,
                            Scratch& scratch, MatcherCosts& costs) const {
  if (used[kCensus]) {
    census_.computeRow(y, entries, scratch.census, costs.census);
  }
  if (used[kNcc]) {
    ncc_.computeRow(y, entries, scratch.ncc, costs.ncc);
  }
  if (used[kZeroMeanSad]) {
    zero_mean_sad_.computeRow(y, entries, scratch.zero_mean_sad, costs.zero_mean_sad);
  }
  if (used[kSobelSad]) {
    sobel_sad_.computeRow(y, entries, scratch.sobel_sad, costs.sobel_sad);
  }
}

}  // namespace cbmv
