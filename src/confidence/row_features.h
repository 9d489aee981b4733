#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "confidence/features.h"
#include "matching/matcher_set.h"
#include "matching/row_entries.h"

namespace cbmv {

/// The 20 features of the hypotheses of one image row: the matchers' costs of the row first, then
/// the terms of its pixels, then features or their codes on demand, of some places at a time. Holds
/// the buffers of a row; one object per thread.
class RowFeatures {
 public:
  /// Makes room for rows of `width` columns with so many entries, so that the functions below
  /// allocate nothing; for values of CodeBlock::kPlaces places at a time, if they are wanted.
  void reserve(int width, std::size_t entries, const MatcherSelection& used, bool wants_values);

  /// Matches the entries of row y of the pair that `matchers` was prepared with. `entries` has to
  /// live as long as features are asked for. Of matchers that are not `used`, the features below
  /// are unspecified and cost no time.
  void prepareRow(const MatcherSet& matchers, int y, int width, const RowEntries& entries,
                  const MatcherSelection& used = allMatchers());

  /// Feature values at `places`: line(f), laid out [place − places.begin][column of the tile].
  /// Those of columns outside of one of the images are unspecified.
  void compute(const PlaceSpan& places);
  const float* line(int feature) const { return values_.data() + feature * pitch_; }

  /// The same as codes, of at most CodeBlock::kPlaces places.
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
  std::size_t pitch_ = 0;  ///< from line to line
  std::vector<float> values_;
  CodeBlock codes_{};
};

}  // namespace cbmv
