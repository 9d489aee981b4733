#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "base/volume.h"
#include "matching/cost_row.h"
#include "matching/matcher_set.h"
#include "matching/row_entries.h"

namespace cbmv {

/// The features of one matcher. Each confidence is computed in both matching directions (Batsos et
/// al. 2018, section 3.2); the forest sees the lower and the higher of the two, so that swapping
/// left and right cannot change its answer. A forest sees only the order of a feature's values, so
/// each stands in a domain where it is cheap to compute:
///   kCost              C for census, log(C + ε) for the others
///   kRatioLow, -High   log R = log(c_min + ε) − log(C + ε)
///   kLikelihoodLow, -High   log L = −(C − c_min)² / 2σ² − log Σ_i exp(−(C_i − c_min)² / 2σ²)
/// where c_min and the sum run over all hypotheses of the search space of the left pixel,
/// respectively of the right one, whose match lies inside of the other image.
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

/// What the confidences need of a pixel of one view, for one matcher; a value a column. Column x
/// has the number kBefore + x: entries that lie partly outside of an image reach beyond its
/// columns.
struct PixelTerms {
  static constexpr int kBefore = kTileColumns;
  using Line = std::vector<float, CacheLineAllocator<float>>;

  Line lowest_cost;      ///< c_min
  Line log_lowest_cost;  ///< log(c_min + ε)
  Line log_sum;          ///< log Σ exp(−(C − c_min)² / 2σ²)

  /// Makes room for `width` columns.
  void reserve(int width);
  /// No hypothesis yet.
  void reset(int width);
};

/// Terms of all pixels of a row in both views. Columns without any hypothesis, and those outside of
/// the image, hold unspecified values.
struct RowTerms {
  PixelTerms left;
  PixelTerms right;
};

/// Computes `terms` of one matcher from its costs of a row of `width` columns.
void computeRowTerms(const CostRowPointer& costs, const RowEntries& entries, int width,
                     const MatcherConstants& constants, RowTerms& terms);

/// The features of one matcher at some places: `values[feature]` points to a value for every column
/// of their entries, [place − places.begin][column of the tile]. Columns outside of one of the
/// images hold unspecified values.
using FeatureLines = std::array<float*, kFeaturesPerMatcher>;
void computeFeatures(const CostRowPointer& costs, const RowTerms& terms, const RowEntries& entries,
                     const PlaceSpan& places, const MatcherConstants& constants,
                     const FeatureLines& values);

/// Linear map of a feature to codes 0 … 255 (values beyond are cut off):
/// code = ⌊scale · value + offset⌋.
struct CodeMap {
  float scale = 1;
  float offset = 0;
};

/// The maps of all features. Low and high of a confidence share one map.
struct FeatureQuantizer {
  std::array<CodeMap, kFeatureCount> maps;
};

/// Codes of `count` values.
void quantize(const CodeMap& map, const float* values, int count, std::uint8_t* codes);

/// Codes of the features of some hypotheses, as the forest takes them: few enough for the
/// first-level cache, and minus 128, since signed bytes compare fastest.
struct CodeBlock {
  static constexpr int kPlaces = 16;
  static constexpr int kHypotheses = kPlaces * kTileColumns;
  using Line = std::array<std::int8_t, kHypotheses>;

  alignas(64) std::array<Line, kFeatureCount> lines;  ///< by feature
};

/// The codes of what computeFeatures computes, without the way through memory; of at most
/// CodeBlock::kPlaces places. `maps` and `lines` are the kFeaturesPerMatcher ones of the matcher.
void computeCodes(const CostRowPointer& costs, const RowTerms& terms, const RowEntries& entries,
                  const PlaceSpan& places, const MatcherConstants& constants, const CodeMap* maps,
                  CodeBlock::Line* lines);

}  // namespace cbmv
