#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

#include "base/search_space.h"
#include "confidence/features.h"
#include "training/sample_labels.h"

#include "cbmv_stereo/disparity_range.h"

namespace cbmv {

/// Labeled hypotheses: feature values (features.h) and whether the hypothesis is correct.
struct Samples : SampleLabels {
  std::array<std::vector<float>, kFeatureCount> features;  ///< one column a feature
};

/// A rectified pair with the truth of its left view.
struct TrainingPair {
  cv::Mat left;   ///< CV_8UC1
  cv::Mat right;  ///< CV_8UC1, rows aligned
  cv::Mat truth;  ///< CV_32FC1, px; not finite = unknown
  cv::Mat mask;   ///< CV_8UC1: 255 = may be sampled
  DisparityRange range;
};

/// The pair at half the size, as the search matches it: images by halveImage, range by halveRange.
/// The truth is half the mean of four pixels that all may be sampled and differ by 2 px at most;
/// elsewhere it is unknown, and the mask 0. The pair is at least 2 × 2 pixels large.
TrainingPair halvePair(const TrainingPair& pair);

/// Rows of a pair whose samples are held out: a tenth of its rows, side by side, at a place that
/// the seed decides; none of a pair of fewer than ten rows.
struct HeldOutBand {
  /// Rows between the band and the rows that are trained on: no window around the former shares a
  /// pixel with one around the latter (the largest has 11 rows), and features know no other rows.
  static constexpr int kMargin = 10;

  HeldOutBand(int rows, std::uint64_t seed);

  /// The same rows of the pair at half the size.
  HeldOutBand halved() const {
    HeldOutBand half = *this;
    half.begin /= 2;
    half.end /= 2;
    return half;
  }

  bool contains(int row) const { return begin <= row && row < end; }
  /// Neither held out nor trained on.
  bool isMargin(int row) const {
    return begin < end && !contains(row) && begin - kMargin <= row && row < end + kMargin;
  }

  int begin = 0;
  int end = 0;  ///< behind the last one
};

/// Draws up to `pixels` pixels of the pair, all equally likely, and appends for each (Batsos et al.
/// 2018, section 3.3) the rounded true disparity as correct and two wrong disparities, one uniform
/// among those of the pixel's list in `space` below truth − 1, one among those above truth + 1, as
/// far as the list has them and they match inside of the right image. The competitors that features
/// know are those of `space`, which is of the size and range of the pair. Samples in the rows of
/// `band` are held out, none is in its margins. The same seed gives the same samples, whatever the
/// number of threads.
void appendSamples(const TrainingPair& pair, const SearchSpace& space, const HeldOutBand& band,
                   long pixels, std::uint64_t seed, Samples& samples);

/// The same with the whole range in every list and the band of this seed.
void appendSamples(const TrainingPair& pair, long pixels, std::uint64_t seed, Samples& samples);

}  // namespace cbmv
