#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "forest/confidence_evaluator.h"
#include "selection/map_planes.h"
#include "selection/window_rows.h"

namespace cbmv {

/// Features of the confidence forest in the order of their names, one byte each. They describe the
/// final disparity of a pixel and the maps around it:
///   probability   of the winner, from the first forest, in 1/255
///   margin        lowest cost more than 1 px away from the winner, minus the cost of the winner
///                 (compressed)
///   left_right    left-right difference in 1/8 px; 255: unknown
///   unmatched     250 where the left-right consistency check failed, otherwise 0
///   border        distance of the match from the left border of the right image, 3 per px,
///                 starting 5 px outside
///   *_5           means over 5 × 5 px of these and of roughness (differences between neighboring
///                 disparities, 64 per px), and the difference between the disparity and its mean
///                 (compressed, 8 per px)
///   *_12, _20, _36   the same over 3, 5 and 9 cells of 4 px
/// Compressed values (compressed()) are unchanged up to 128; above, they rise by 1 per 16.
const std::vector<std::string>& confidenceFeatureNames();

/// Index of the feature that defines the roughness bins of the standard deviation model.
int roughnessFeature();

/// Computes the features of a row of pixels. Has memory for one row.
class ConfidenceFeatures {
 public:
  static constexpr int kBlock = ConfidenceCodes::kQueries;  ///< most pixels per call of code()

  void resize(int width);
  /// Selects row `y`. `planes` must not change until the last block.
  void startRow(const MapPlanes& planes, int y);
  /// Computes the codes of the `count` pixels from `x` on. `x` is a multiple of CellGrid::kCellPx.
  void code(int x, int count, ConfidenceCodes& codes) const;

 private:
  const MapPlanes* planes_ = nullptr;
  int y_ = 0;
  WindowRow unmatched_;
  WindowRow probability_;
  WindowRow margin_;
  WindowRow roughness_;
  WindowRow disparity_;
  const std::int32_t* unmatched_sums_ = nullptr;
  const std::int32_t* probability_sums_ = nullptr;
  const std::int32_t* margin_sums_ = nullptr;
  const std::int32_t* roughness_sums_ = nullptr;
  const std::int32_t* disparity_sums_ = nullptr;
};

}  // namespace cbmv
