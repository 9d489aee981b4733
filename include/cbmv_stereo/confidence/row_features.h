#pragma once

#include <array>
#include <vector>

#include "cbmv_stereo/confidence/features.h"
#include "cbmv_stereo/matching/matcher_set.h"

namespace cbmv {

/// All 20 features of one image row, one disparity at a time: the matchers' costs of the row first,
/// then the terms of its pixels, then features on demand. Holds the buffers of a row; one object
/// per thread.
class RowFeatures {
 public:
  /// Matches row y of the pair that `matchers` was prepared with.
  void prepareRow(const MatcherSet& matchers, int y, int width, const DisparityRange& range);

  /// Feature values at disparity range.min + i: line(f)[x] for x in
  /// matchedColumns(width, range.min + i).
  void compute(int i);
  const float* line(int feature) const { return values_.data() + feature * width_; }

 private:
  int width_ = 0;
  DisparityRange range_;
  MatcherSet::Scratch scratch_;
  MatcherCosts costs_;
  std::array<RowTerms, kMatcherCount> terms_;
  std::vector<float> values_;
};

}  // namespace cbmv
