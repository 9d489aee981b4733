#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "confidence/row_features.h"
#include "forest/forest_evaluator.h"

namespace cbmv {

/// Inputs for scoring the hypotheses of a pair, the same for all rows.
struct Scoring {
  const MatcherSet& matchers;  ///< prepared with the pair
  const Forest& forest;
  const ForestEvaluator& evaluator;
  MatcherSelection asked;  ///< the matchers that the forest uses
};

/// Scores the hypotheses of one row at a time: matchers, features, forest. Has the buffers of a
/// row: use one object per thread.
class RowScorer {
 public:
  /// Makes room for rows of `width` columns with `entries` entries, so that `score` does not
  /// allocate.
  void reserve(const Scoring& scoring, int width, std::size_t entries) {
    features_.reserve(width, entries, scoring.asked, scoring.evaluator.wantsValues());
  }

  /// Calls store(entry, costs) for the entries of row y, in their order. `costs` are the
  /// kTileColumns costs of an entry. Hypotheses outside of one of the images have kOutsideCost.
  template <typename Store>
  void score(const Scoring& scoring, int y, int width, const RowEntries& entries,
             const Store& store) {
    features_.prepareRow(scoring.matchers, y, width, entries, scoring.asked);
    for (int place = 0; place < entries.count(); place += CodeBlock::kPlaces) {
      const PlaceSpan places{place, std::min(place + CodeBlock::kPlaces, entries.count())};
      evaluate(scoring, places);
      std::uint8_t* costs = costs_.data();
      for (int p = places.begin; p < places.end; ++p) {
        const RowEntries::Entry& entry = entries.entries()[p];
        if (!entry.isWhole()) {
          std::fill(costs, costs + entry.begin, kOutsideCost);
          std::fill(costs + entry.end, costs + kTileColumns, kOutsideCost);
        }
        store(entry, costs);
        costs += kTileColumns;
      }
    }
  }

 private:
  void evaluate(const Scoring& scoring, const PlaceSpan& places) {
    const int count = places.count() * kTileColumns;
    if (scoring.evaluator.wantsValues()) {
      features_.compute(places);
      std::array<const float*, kFeatureCount> lines{};
      for (int f = 0; f < kFeatureCount; ++f) {
        lines[f] = features_.line(f);
      }
      scoring.evaluator.evaluate(lines, count, costs_.data());
    } else {
      features_.computeCodes(places, scoring.forest.quantizer);
      scoring.evaluator.evaluate(features_.codes(), count, costs_.data());
    }
  }

  RowFeatures features_;
  alignas(64) std::array<std::uint8_t, CodeBlock::kHypotheses> costs_{};
};

}  // namespace cbmv
