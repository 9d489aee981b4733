#pragma once

#include <cmath>
#include <cstdint>
#include <memory>

#include "selection/confidence_features.h"
#include "selection/selection_features.h"
#include "support/random_forest.h"
#include "support/selection_reference.h"

namespace cbmv::test {

/// Random trees with the features of MapConfidence; about half of all pixels are confident.
inline ConfidenceForest makeMapForest(std::uint32_t seed) {
  ConfidenceForest forest =
      makeConfidenceForest(static_cast<int>(confidenceFeatureNames().size()), 12, 5, seed);
  addSigmaModel(forest);
  forest.feature_names = confidenceFeatureNames();
  forest.bias = 1.75;
  return forest;
}

/// A few random trees with the features of MapSelector, so that many scores are equal.
inline ConfidenceForest makeSelectionForest(std::uint32_t seed) {
  ConfidenceForest forest =
      makeConfidenceForest(static_cast<int>(selectionFeatureNames().size()), 6, 3, seed);
  forest.feature_names = selectionFeatureNames();
  return forest;
}

/// Adds random second forests to the forest.
inline void addSecondForest(std::uint32_t seed, Forest& forest) {
  forest.confidence = std::make_shared<ConfidenceForest>(makeMapForest(seed));
  forest.selection = std::make_shared<ConfidenceForest>(makeSelectionForest(seed + 1));
}

/// Log-odds for features given by name.
inline double naiveLogOdds(const ConfidenceForest& forest, const NamedValues& features) {
  return naiveLogOdds(forest, [&](int f) { return features.at(forest.feature_names[f]); });
}

inline int naiveProbabilityByte(double log_odds) {
  return static_cast<int>(std::lround(255 / (1 + std::exp(-log_odds))));
}

/// Confidence of the forest for a map.
inline cv::Mat naiveConfidence(const ConfidenceForest& forest, const MapPlanes& planes,
                               const cv::Mat& disparity, float invalid) {
  cv::Mat confidence(disparity.size(), CV_8UC1);
  for (int y = 0; y < disparity.rows; ++y) {
    for (int x = 0; x < disparity.cols; ++x) {
      const int byte =
          disparity.at<float>(y, x) == invalid
              ? 0
              : naiveProbabilityByte(naiveLogOdds(forest, naiveConfidenceFeatures(planes, y, x)));
      confidence.at<std::uint8_t>(y, x) = static_cast<std::uint8_t>(byte);
    }
  }
  return confidence;
}

}  // namespace cbmv::test
