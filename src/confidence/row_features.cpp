#include "confidence/row_features.h"

namespace cbmv {

template <typename Use>
void RowFeatures::forUsedMatchers(const Use& use) const {
  for (int m = 0; m < kMatcherCount; ++m) {
    if (used_[m]) {
      use(m);
    }
  }
}

void RowFeatures::reserve(int width, std::size_t entries, const MatcherSelection& used,
                          bool wants_values) {
  used_ = used;
  scratch_.resize(width);
  costs_.resize(entries, used);
  forUsedMatchers([&](int m) {
    terms_[m].left.reserve(width);
    terms_[m].right.reserve(width);
  });
  if (wants_values) {
    values_.reserve(static_cast<std::size_t>(kFeatureCount) * CodeBlock::kHypotheses);
  }
}

void RowFeatures::prepareRow(const MatcherSet& matchers, int y, int width,
                             const RowEntries& entries, const MatcherSelection& used) {
  entries_ = &entries;
  used_ = used;
  matchers.computeRow(y, entries, used, scratch_, costs_);
  forUsedMatchers([&](int m) {
    computeRowTerms(costs_.rows()[m], entries, width, kMatcherConstants[m], terms_[m]);
  });
}

void RowFeatures::compute(const PlaceSpan& places) {
  pitch_ = static_cast<std::size_t>(places.count()) * kTileColumns;
  values_.resize(kFeatureCount * pitch_);
  forUsedMatchers([&](int m) {
    FeatureLines lines{};
    for (int f = 0; f < kFeaturesPerMatcher; ++f) {
      lines[f] = values_.data() + featureIndex(m, f) * pitch_;
    }
    computeFeatures(costs_.rows()[m], terms_[m], *entries_, places, kMatcherConstants[m], lines);
  });
}

void RowFeatures::computeCodes(const PlaceSpan& places, const FeatureQuantizer& quantizer) {
  forUsedMatchers([&](int m) {
    const int first = featureIndex(m, 0);
    cbmv::computeCodes(costs_.rows()[m], terms_[m], *entries_, places, kMatcherConstants[m],
                       &quantizer.maps[first], &codes_.lines[first]);
  });
}

}  // namespace cbmv
