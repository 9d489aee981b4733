#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "cbmv_stereo/confidence/features.h"
#include "cbmv_stereo/matching/matcher_set.h"

namespace cbmv {

/// The 20 features of one image row, one disparity at a time: the matchers' costs of the row first,
/// then the terms of its pixels, then features or their codes on demand. Holds the buffers of a
/// row; one object per thread.
class RowFeatures {
 public:
  /// Makes room for rows of `width` columns, so that the functions below allocate nothing; for
  /// codes or for values.
  void reserve(int width, const DisparityRange& range, const MatcherSelection& used,
               bool wants_codes);

  /// Matches row y of the pair that `matchers` was prepared with. Of matchers that are not `used`,
  /// the features below are unspecified and cost no time.
  void prepareRow(const MatcherSet& matchers, int y, int width, const DisparityRange& range,
                  const MatcherSelection& used = allMatchers());

  /// Feature values at disparity range.min + i: line(f)[x] for x in
  /// matchedColumns(width, range.min + i).
  void compute(int i);
  const float* line(int feature) const { return values_.data() + lineOffset(feature); }

  /// The same as codes: codes(f)[x].
  void computeCodes(int i, const FeatureQuantizer& quantizer);
  const std::uint8_t* codes(int feature) const { return codes_.data() + lineOffset(feature); }

 private:
  template <typename Use>
  void forUsedMatchers(const Use& use) const;
  std::size_t lineOffset(int feature) const { return static_cast<std::size_t>(feature) * width_; }

  int width_ = 0;
  DisparityRange range_;
  MatcherSelection used_;
  MatcherSet::Scratch scratch_;
  MatcherCosts costs_;
  std::array<RowTerms, kMatcherCount> terms_;
  std::vector<float> values_;
  std::vector<std::uint8_t> codes_;
};

}  // namespace cbmv
