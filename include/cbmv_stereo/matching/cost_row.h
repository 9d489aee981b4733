#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "cbmv_stereo/volume/disparity_range.h"

namespace cbmv {

/// Half-open interval of columns.
struct ColumnSpan {
  int begin = 0;
  int end = 0;
  bool empty() const { return begin >= end; }
};

/// Left columns x whose match x − d lies inside of the right image.
inline ColumnSpan matchedColumns(int width, int d) {
  return {std::max(0, d), std::min(width, width + d)};
}

/// Matching costs of all hypotheses of one image row, laid out [d][x] with x contiguous: for one d,
/// neighbours of both views are neighbours in memory. Line i stands for d = range.min + i; outside
/// of matchedColumns(width, d) its values are unspecified.
class CostRow {
 public:
  void resize(int width, int disparities) {
    width_ = width;
    costs_.resize(static_cast<std::size_t>(width) * disparities);
  }
  float* line(int i) { return costs_.data() + static_cast<std::size_t>(i) * width_; }
  const float* line(int i) const { return costs_.data() + static_cast<std::size_t>(i) * width_; }

 private:
  int width_ = 0;
  std::vector<float> costs_;
};

}  // namespace cbmv
