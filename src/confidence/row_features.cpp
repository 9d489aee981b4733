#include "cbmv_stereo/confidence/row_features.h"

namespace cbmv {

template <typename Use>
void RowFeatures::forUsedMatchers(const Use& use) const {
  for (int m = 0; m < kMatcherCount; ++m) {
    if (used_[m]) {
      use(m);
    }
  }
}

void RowFeatures::reserve(int width, const DisparityRange& range, const MatcherSelection& used,
                          bool wants_codes) {
  width_ = width;
  used_ = used;
  scratch_.resize(width);
  costs_.resize(width, range.count, used);
  forUsedMatchers([&](int m) {
    terms_[m].left.reserve(width);
    terms_[m].right.reserve(width);
  });
  if (wants_codes) {
    codes_.resize(lineOffset(kFeatureCount));
  } else {
    values_.resize(lineOffset(kFeatureCount));
  }
}

void RowFeatures::prepareRow(const MatcherSet& matchers, int y, int width,
                             const DisparityRange& range, const MatcherSelection& used) {
  width_ = width;
  range_ = range;
  used_ = used;
  matchers.computeRow(y, range, used, scratch_, costs_);
  forUsedMatchers([&](int m) {
    computeRowTerms(costs_.rows()[m], width, range, kMatcherConstants[m], terms_[m]);
  });
}

void RowFeatures::compute(int i) {
  values_.resize(lineOffset(kFeatureCount));
  forUsedMatchers([&](int m) {
    FeatureLines lines{};
    for (int f = 0; f < kFeaturesPerMatcher; ++f) {
      lines[f] = values_.data() + lineOffset(featureIndex(m, f));
    }
    computeFeatures(costs_.rows()[m], terms_[m], width_, range_, i, kMatcherConstants[m], lines);
  });
}

void RowFeatures::computeCodes(int i, const FeatureQuantizer& quantizer) {
  codes_.resize(lineOffset(kFeatureCount));
  forUsedMatchers([&](int m) {
    CodeLines lines{};
    MatcherCodeMaps maps{};
    for (int f = 0; f < kFeaturesPerMatcher; ++f) {
      lines[f] = codes_.data() + lineOffset(featureIndex(m, f));
      maps[f] = quantizer.maps[featureIndex(m, f)];
    }
    cbmv::computeCodes(costs_.rows()[m], terms_[m], width_, range_, i, kMatcherConstants[m], maps,
                       lines);
  });
}

}  // namespace cbmv
