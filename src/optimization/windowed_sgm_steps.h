#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include <opencv2/core.hpp>

#include "base/search_space.h"
#include "optimization/edge_maps.h"
#include "optimization/sgm_penalties.h"

#include "cbmv_stereo/disparity_range.h"

namespace cbmv {

/// What the steps of paths between the pixels of two neighbouring rows, or along a row, meet.
/// Pointers are to the step to column 0 and may be read for all columns of the tiles, those beyond
/// the image included, and 16 more.
struct PathSteps {
  const std::int8_t* reference_edges;  ///< -1: edge, else 0
  /// The same in the other image; of the hypothesis of index i in column x at [x + slope * i].
  const std::int8_t* other_edges;
  int slope;
  /// Disparities that the surface rises, in {-1, 0, 1}, in the direction of growing coordinates.
  const std::int8_t* rises;

  /// The steps to the columns from x on.
  PathSteps from(std::ptrdiff_t x) const {
    return {reference_edges + x, other_edges + x, slope, rises + x};
  }
};

/// The steps of an image pair from left to right or from top to bottom. The opposite step is the
/// same one with a rise of opposite sign.
class StepMap {
 public:
  enum class Axis { kHorizontal, kVertical };

  /// `surface` as in windowed_sgm.h.
  void find(const EdgeImages& images, const cv::Mat& surface, View view, const SearchSpace& space,
            Axis axis);

  /// Steps to the pixels of a row from their left or upper neighbours. There is neither an edge nor
  /// a rise where a neighbour is missing.
  PathSteps row(int y) const;

 private:
  int slope_ = 0;
  std::ptrdiff_t first_other_ = 0;  ///< of column 0 and index 0 in a row of other_
  cv::Mat reference_;
  cv::Mat other_;
  cv::Mat rises_;  ///< a single row where there is no surface
};

}  // namespace cbmv
