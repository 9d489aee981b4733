#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "cbmv_stereo/matching/cost_row.h"
#include "cbmv_stereo/matching/matcher_set.h"
#include "cbmv_stereo/volume/disparity_range.h"

namespace cbmv {

/// The features of one matcher. Each confidence is computed in both matching directions (Batsos et
/// al. 2018, section 3.2); the forest sees the lower and the higher of the two, so that swapping
/// left and right cannot change its answer. A forest sees only the order of a feature's values, so
/// each stands in a domain where it is cheap to compute:
///   kCost              C for census, log(C + ε) for the others
///   kRatioLow, -High   log R = log(c_min + ε) − log(C + ε)
///   kLikelihoodLow, -High   log L = −(C − c_min)² / 2σ² − log Σ_i exp(−(C_i − c_min)² / 2σ²)
/// where c_min and the sum run over all hypotheses of the left pixel, respectively of the right
/// one, whose match lies inside of the other image.
enum Feature { kCost, kRatioLow, kRatioHigh, kLikelihoodLow, kLikelihoodHigh };
constexpr int kFeaturesPerMatcher = 5;
constexpr int kFeatureCount = kMatcherCount * kFeaturesPerMatcher;

/// Number of a matcher's feature among all: matcher · 5 + feature.
constexpr int featureIndex(int matcher, int feature) {
  return matcher * kFeaturesPerMatcher + feature;
}

/// Constants of the confidences of one matcher (ibid.).
struct MatcherConstants {
  float cost_unit;          ///< what 1 in a CostRow stands for
  float epsilon;            ///< ε of the ratio: keeps C + ε positive
  float two_sigma_squared;  ///< 2σ² of the likelihood, in squared units of the cost
  bool logarithmic_cost;    ///< kCost is log(C + ε)
};
constexpr std::array<MatcherConstants, kMatcherCount> kMatcherConstants = {{
    {1.0F, 0.01F, 128.0F, false},                                       // census
    {1.0F, 1.01F, 0.02F, true},                                         // NCC
    {1.0F / ZeroMeanSadMatcher::kUnitsPerGrey, 0.01F, 20000.0F, true},  // zero-mean SAD
    {1.0F, 0.01F, 20000.0F, true},                                      // Sobel SAD
}};

/// What the confidences need of a pixel of one view, for one matcher; a value a column.
struct PixelTerms {
  std::vector<float> lowest_cost;      ///< c_min
  std::vector<float> log_lowest_cost;  ///< log(c_min + ε)
  std::vector<float> log_sum;          ///< log Σ exp(−(C − c_min)² / 2σ²)

  /// Makes room for `width` columns.
  void reserve(int width);
};

/// Terms of all pixels of a row in both views. Columns without any hypothesis inside hold
/// unspecified values.
struct RowTerms {
  PixelTerms left;
  PixelTerms right;
};

/// Computes `terms` of one matcher from its costs of a row of `width` columns; from those of `spans`
/// alone where they are given.
void computeRowTerms(const CostRowPointer& costs, int width, const DisparityRange& range,
                     const MatcherConstants& constants, RowTerms& terms,
                     const RowSpans* spans = nullptr);

/// The features of one matcher at one disparity: `values[feature]` points to `width` values, of
/// which those in matchedColumns(width, range.min + i) are written.
using FeatureLines = std::array<float*, kFeaturesPerMatcher>;
void computeFeatures(const CostRowPointer& costs, const RowTerms& terms, int width,
                     const DisparityRange& range, int i, const MatcherConstants& constants,
                     const FeatureLines& values);

/// Linear map of a feature to codes 0 … 255 (values beyond are cut off):
/// code = ⌊scale · value + offset⌋.
struct CodeMap {
  float scale = 1;
  float offset = 0;
};
using MatcherCodeMaps = std::array<CodeMap, kFeaturesPerMatcher>;

/// The maps of all features. Low and high of a confidence share one map.
struct FeatureQuantizer {
  std::array<CodeMap, kFeatureCount> maps;
};

/// Codes of `count` values.
void quantize(const CodeMap& map, const float* values, int count, std::uint8_t* codes);

/// The codes of what computeFeatures computes, without the way through memory.
using CodeLines = std::array<std::uint8_t*, kFeaturesPerMatcher>;
void computeCodes(const CostRowPointer& costs, const RowTerms& terms, int width,
                  const DisparityRange& range, int i, const MatcherConstants& constants,
                  const MatcherCodeMaps& maps, const CodeLines& codes);

/// The same of the columns `span` alone, which lie inside of matchedColumns(width, range.min + i).
void computeFeaturesInSpan(const CostRowPointer& costs, const RowTerms& terms,
                           const ColumnSpan& span, const DisparityRange& range, int i,
                           const MatcherConstants& constants, const FeatureLines& values);
void computeCodesInSpan(const CostRowPointer& costs, const RowTerms& terms, const ColumnSpan& span,
                        const DisparityRange& range, int i, const MatcherConstants& constants,
                        const MatcherCodeMaps& maps, const CodeLines& codes);

}  // namespace cbmv
