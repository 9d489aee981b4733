#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "confidence/features.h"
#include "matching/matcher_set.h"
#include "matching/row_entries.h"

namespace cbmv {

/// The 20 features of the hypotheses of one image row. Computes the matching costs of the row
/// first, then the terms of its pixels, then on demand the features or their codes of some places.
/// Has the buffers of a row: use one object per thread.
class RowFeatures {
 public:
  /// Makes room for rows of `width` columns with `entries` entries, so that the functions below do
  /// not allocate. With `wants_values`, also for the values of CodeBlock::kPlaces places.
  void reserve(int width, std::size_t entries, const MatcherSelection& used, bool wants_values);

  /// Matches the entries of row y of the pair that `matchers` was prepared with. `entries` must
  /// exist as long as features are computed. Features of matchers that are not `used` are
  /// unspecified and take no time.
  void prepareRow(const MatcherSet& matchers, int y, int width, const RowEntries& entries,
                  const MatcherSelection& used = allMatchers());

  /// Computes feature values at `places`: line(f), laid out [place − places.begin][column of the
  /// tile]. Values of columns outside of one of the images are unspecified.
  void compute(const PlaceSpan& places);
  const float* line(int feature) const { return values_.data() + feature * pitch_; }

  /// Computes the codes of the features at no more than CodeBlock::kPlaces places.
  void computeCodes(const PlaceSpan& places, const FeatureQuantizer& quantizer);
  const CodeBlock& codes() const { return codes_; }

 private:
  template <typename Use>
  void forUsedMatchers(const Use& use) const;

  const RowEntries* entries_ = nullptr;
  MatcherSelection used_;
  MatcherSet::Scratch scratch_;
  MatcherCosts costs_;
  std::array<RowTerms, kMatcherCount> terms_;
  std::size_t pitch_ = 0;  ///< distance between lines
  std::vector<float> values_;
  CodeBlock codes_{};
};

}  // namespace cbmv
