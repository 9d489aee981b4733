#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include <opencv2/core.hpp>

#include "base/volume.h"

#include "cbmv_stereo/disparity_range.h"

namespace cbmv {

/// One value per column of a row of the other image. The order makes the values at the matching
/// columns of a pixel's hypotheses d = min, min + 1, … contiguous: reversed for the left view,
/// where the matching column decreases as d grows. A whole vector may be read from any value.
template <typename Value>
class MatchingRow {
 public:
  /// Makes room for the reference pixels in `columns` and the disparities of `range`.
  void resize(View view, const cv::Range& columns, const DisparityRange& range) {
    forward_ = view == View::kRight;
    columns_ = columns;
    first_match_ = matchingColumn(view, forward_ ? columns.start : columns.end - 1, range.min);
    matches_ = columns.size() + range.count - 1;
    values_.resize(matches_ + kReadableBytesBeyond / sizeof(Value));
  }

  /// Copies the values of a row of the other image. Columns outside of its `width` get `outside`.
  void fill(const Value* row, int width, Value outside) {
    // The column of value i is first_match_ + i or first_match_ − i.
    const int lowest = forward_ ? -first_match_ : first_match_ - (width - 1);
    const int begin = std::clamp(lowest, 0, matches_);
    const int end = std::clamp(lowest + width, begin, matches_);
    std::fill_n(values_.begin(), begin, outside);
    std::fill(values_.begin() + end, values_.begin() + matches_, outside);
    if (forward_) {
      std::copy(row + first_match_ + begin, row + first_match_ + end, values_.begin() + begin);
    } else {
      std::reverse_copy(row + first_match_ - end + 1, row + first_match_ - begin + 1,
                        values_.begin() + begin);
    }
  }

  int size() const { return matches_; }
  const Value* data() const { return values_.data(); }

  /// Offset in data() of the hypotheses of column x.
  std::ptrdiff_t offset(int x) const {
    return forward_ ? x - columns_.start : columns_.end - 1 - x;
  }

 private:
  bool forward_ = false;
  cv::Range columns_;
  int first_match_ = 0;
  int matches_ = 0;
  std::vector<Value> values_;
};

}  // namespace cbmv
