#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "forest/confidence_evaluator.h"
#include "selection/map_planes.h"
#include "selection/window_rows.h"

namespace cbmv {

/// Features of the confidence forest, one byte each, in the order of their names. They describe the
/// final disparity of a pixel and the maps around it:
///   probability   of the winner, by the first forest, in 1/255
///   margin        from the winner's cost to the best one more than 1 px away (compressed)
///   left_right    difference of both views in 1/8 px; 255: unknown
///   unmatched     250 where the left-right check failed, else 0
///   border        distance of the match from the left border of the right image, 3 per px, from
///                 5 px outside on
///   *_5           means over 5 × 5 px of these, of roughness (steps between neighbouring
///                 disparities, 64 per px), and the distance of the disparity from its mean
///                 (compressed, 8 per px)
///   *_12, _20, _36   the same over 3, 5 and 9 cells of 4 px
/// Compressed values are as they are up to 128 and count 1/16 beyond (compressed()).
const std::vector<std::string>& confidenceFeatureNames();

/// Number of the feature whose bins the model of the standard deviation has.
int roughnessFeature();

/// Computes the features of a row of pixels. Holds memory for one row.
class ConfidenceFeatures {
 public:
  static constexpr int kBlock = ConfidenceCodes::kQueries;  ///< most pixels that are coded at once

  void resize(int width);
  /// Of row `y`; `planes` must stay as they are until the last block.
  void startRow(const MapPlanes& planes, int y);
  /// Codes of the `count` pixels from `x` on, a multiple of CellGrid::kCellPx.
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
