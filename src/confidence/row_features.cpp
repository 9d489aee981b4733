#include "cbmv_stereo/confidence/row_features.h"

namespace cbmv {

void RowFeatures::prepareRow(const MatcherSet& matchers, int y, int width,
                             const DisparityRange& range) {
  width_ = width;
  range_ = range;
  values_.resize(static_cast<std::size_t>(width) * kFeatureCount);
  matchers.computeRow(y, range, scratch_, costs_);
  for (int m = 0; m < kMatcherCount; ++m) {
    computeRowTerms(costs_[m], width, range, kMatcherConstants[m], terms_[m]);
  }
}

void RowFeatures::compute(int i) {
  for (int m = 0; m < kMatcherCount; ++m) {
    FeatureLines lines{};
    for (int f = 0; f < kFeaturesPerMatcher; ++f) {
      lines[f] = values_.data() + static_cast<std::size_t>(featureIndex(m, f)) * width_;
    }
    computeFeatures(costs_[m], terms_[m], width_, range_, i, kMatcherConstants[m], lines);
  }
}

}  // namespace cbmv
