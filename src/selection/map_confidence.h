#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "base/per_thread.h"
#include "forest/confidence_evaluator.h"
#include "forest/confidence_forest.h"
#include "selection/confidence_features.h"
#include "selection/map_planes.h"

namespace cbmv {

/// Applies the confidence forest to the maps of a pair. The object keeps its memory from pair to
/// pair, so it processes one pair at a time.
class MapConfidence {
 public:
  /// Throws Error if the features of the forest are not confidenceFeatureNames. `forest` must
  /// outlive the object.
  MapConfidence(const ConfidenceForest& forest, const std::string& file_name);

  /// Computes for each pixel the probability that its disparity is within 1 px of the true
  /// disparity; 0 where there is no disparity. Valid until the next pair. `maps` must not change
  /// until then. Parallel over rows by oneTBB.
  void estimate(const JudgedMaps& maps);

  const MapPlanes& planes() const { return planes_; }
  const cv::Mat& confidence() const { return confidence_; }  ///< CV_8UC1, in 1/255
  /// CV_8UC1: roughness bin of each pixel for the standard deviation model.
  const cv::Mat& roughnessBins() const { return roughness_bins_; }

 private:
  struct Row {
    ConfidenceFeatures features;
    ConfidenceCodes codes;
    alignas(64) std::array<std::uint16_t, ConfidenceCodes::kQueries> scores{};
  };

  void estimateRow(int y, Row& row);

  const ConfidenceForest& forest_;
  ConfidenceEvaluator evaluator_;
  MapPlanes planes_;
  cv::Mat confidence_;
  cv::Mat roughness_bins_;
  PerThread<Row> rows_;
};

}  // namespace cbmv
