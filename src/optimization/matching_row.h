#pragma once

#include <cstddef>
#include <vector>

#include <opencv2/core.hpp>

#include "cbmv_stereo/volume/disparity_range.h"
#include "cbmv_stereo/volume/volume.h"

namespace cbmv {

/// One value per column of a row of the other image, ordered such that the values at the matching
/// columns of a reference pixel's hypotheses d = min, min + 1, … are contiguous: reversed for the
/// left view, where the matching column falls as d grows. Whole vectors may be read from any of
/// them on.
template <typename Value>
class MatchingRow {
 public:
  /// Makes room for the reference pixels in `columns` and the disparities in `range`.
  void resize(View view, const cv::Range& columns, const DisparityRange& range) {
    forward_ = view == View::kRight;
    columns_ = columns;
    first_match_ = matchingColumn(view, forward_ ? columns.start : columns.end - 1, range.min);
    values_.resize(static_cast<std::size_t>(columns.size() + range.count - 1) +
                   kReadableBytesBeyond / sizeof(Value));
  }

  /// Takes value_at(column) for columns in [0, width), `outside` for all others.
  template <typename ValueAt>
  void fill(int width, Value outside, const ValueAt& value_at) {
    int column = first_match_;
    const int step = forward_ ? 1 : -1;
    for (Value& value : values_) {
      value = column >= 0 && column < width ? value_at(column) : outside;
      column += step;
    }
  }

  std::size_t size() const { return values_.size(); }
  const Value* data() const { return values_.data(); }

  /// Where the hypotheses of column x start in data().
  std::ptrdiff_t offset(int x) const {
    return forward_ ? x - columns_.start : columns_.end - 1 - x;
  }
  const Value* hypotheses(int x) const { return values_.data() + offset(x); }

 private:
  bool forward_ = false;
  cv::Range columns_;
  int first_match_ = 0;
  std::vector<Value> values_;
};

}  // namespace cbmv
