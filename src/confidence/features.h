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
/// al. 2018, section 3.2). The forest uses the lower and the higher of the two, so its result does
/// not change if left and right are swapped. A forest depends only on the order of the values of a
/// feature, so each feature has a form that is cheap to compute:
///   kCost              C for census, log(C + ε) for the others
///   kRatioLow, -High   log R = log(c_min + ε) − log(C + ε)
///   kLikelihoodLow, -High   log L = −(C − c_min)² / 2σ² − log Σ_i exp(−(C_i − c_min)² / 2σ²)
/// c_min and the sum are over all hypotheses of the search space of the left pixel (or of the right
/// pixel) whose match is inside of the other image.
enum Feature { kCost, kRatioLow, kRatioHigh, kLikelihoodLow, kLikelihoodHigh };
constexpr int kFeaturesPerMatcher = 5;
constexpr int kFeatureCount = kMatcherCount * kFeaturesPerMatcher;

/// Index of a matcher's feature among all features: matcher · 5 + feature.
constexpr int featureIndex(int matcher, int feature) {
  return matcher * kFeaturesPerMatcher + feature;
}

/// Constants for the features of one matcher (Batsos et al. 2018, section 3.2).
struct MatcherConstants {
  float cost_unit;          ///< cost of 1 in a CostRow
  float epsilon;            ///< ε of the ratio; keeps C + ε positive
  float two_sigma_squared;  ///< 2σ² of the likelihood, in squared units of the cost
  bool logarithmic_cost;    ///< kCost is log(C + ε)
};
constexpr std::array<MatcherConstants, kMatcherCount> kMatcherConstants = {{
    {1.0F, 0.01F, 128.0F, false},                                       // census
    {1.0F, 1.01F, 0.02F, true},                                         // NCC
    {1.0F / ZeroMeanSadMatcher::kUnitsPerGray, 0.01F, 20000.0F, true},  // zero-mean SAD
    {1.0F, 0.01F, 20000.0F, true},                                      // Sobel SAD
}};

/// Terms of the features per pixel of one view, for one matcher: one value per column. Column x has
/// the index kBefore + x, because entries that are partly outside of an image extend beyond its
/// columns.
struct PixelTerms {
  static constexpr int kBefore = kTileColumns;
  using Line = std::vector<float, CacheLineAllocator<float>>;

  Line lowest_cost;      ///< c_min
  Line log_lowest_cost;  ///< log(c_min + ε)
  Line log_sum;          ///< log Σ exp(−(C − c_min)² / 2σ²)

  /// Makes room for `width` columns.
  void reserve(int width);
  /// Resets to pixels without a hypothesis.
  void reset(int width);
};

/// Terms of all pixels of a row in both views. Columns without a hypothesis and columns outside of
/// the image have unspecified values.
struct RowTerms {
  PixelTerms left;
  PixelTerms right;
};

/// Computes the `terms` of one matcher from its costs of a row of `width` columns.
void computeRowTerms(const CostRowPointer& costs, const RowEntries& entries, int width,
                     const MatcherConstants& constants, RowTerms& terms);

/// Features of one matcher at some places. `values[feature]` points to one value per column of
/// their entries: [place − places.begin][column of the tile]. Columns outside of one of the images
/// have unspecified values.
using FeatureLines = std::array<float*, kFeaturesPerMatcher>;
void computeFeatures(const CostRowPointer& costs, const RowTerms& terms, const RowEntries& entries,
                     const PlaceSpan& places, const MatcherConstants& constants,
                     const FeatureLines& values);

/// Linear map from a feature to a code: code = ⌊scale · value + offset⌋, clamped to 0 … 255.
struct CodeMap {
  float scale = 1;
  float offset = 0;
};

/// The maps of all features. The low and the high feature of a confidence have the same map.
struct FeatureQuantizer {
  std::array<CodeMap, kFeatureCount> maps;
};

/// Computes the codes of `count` values.
void quantize(const CodeMap& map, const float* values, int count, std::uint8_t* codes);

/// Codes of the features of some hypotheses, in the layout for the forest. A block fits into the
/// first-level cache. Codes are stored minus 128, because signed bytes compare fastest.
struct CodeBlock {
  static constexpr int kPlaces = 16;
  static constexpr int kHypotheses = kPlaces * kTileColumns;
  using Line = std::array<std::int8_t, kHypotheses>;

  alignas(64) std::array<Line, kFeatureCount> lines;  ///< per feature
};

/// Computes the codes of the features without storing the features, for at most CodeBlock::kPlaces
/// places. `maps` and `lines` are the kFeaturesPerMatcher ones of the matcher.
void computeCodes(const CostRowPointer& costs, const RowTerms& terms, const RowEntries& entries,
                  const PlaceSpan& places, const MatcherConstants& constants, const CodeMap* maps,
                  CodeBlock::Line* lines);

}  // namespace cbmv
