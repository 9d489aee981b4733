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

/// Edges and surface rises at the steps between the pixels of two neighboring rows or along a row.
/// Pointers are to the step to column 0. They can be read for all columns of the tiles, including
/// columns beyond the image, and 16 more.
struct PathSteps {
  const std::int8_t* reference_edges;  ///< -1: edge, otherwise 0
  /// The same for the other image. The value for the hypothesis of index i in column x is at [x +
  /// slope * i].
  const std::int8_t* other_edges;
  int slope;
  /// Rise of the surface in disparities, in {-1, 0, 1}, in the direction of increasing coordinates.
  const std::int8_t* rises;

  /// The steps to the columns from x on.
  PathSteps from(std::ptrdiff_t x) const {
    return {reference_edges + x, other_edges + x, slope, rises + x};
  }
};

/// The steps of an image pair from left to right or from top to bottom. The opposite step has the
/// same edges and a rise of opposite sign.
class StepMap {
 public:
  enum class Axis { kHorizontal, kVertical };

  /// `surface` is as in windowed_sgm.h.
  void find(const EdgeImages& images, const cv::Mat& surface, View view, const SearchSpace& space,
            Axis axis);

  /// Steps to the pixels of a row from their left or upper neighbors. There is no edge and no rise
  /// where the neighbor is missing.
  PathSteps row(int y) const;

 private:
  int slope_ = 0;
  std::ptrdiff_t first_other_ = 0;  ///< column 0 and index 0 in a row of other_
  cv::Mat reference_;
  cv::Mat other_;
  cv::Mat rises_;  ///< a single row if there is no surface
};

}  // namespace cbmv
