#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <variant>
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

/// The hypotheses of a row that are matched: for each disparity of a range, spans of columns.
class RowSpans {
 public:
  /// Begins anew, without a span.
  void reset(int disparities) {
    spans_.resize(disparities);
    for (std::vector<ColumnSpan>& spans : spans_) {
      spans.clear();
    }
  }
  /// Adds columns at disparity range.min + i, behind those that it has; neighbours become one span.
  void add(int i, const ColumnSpan& span) {
    std::vector<ColumnSpan>& spans = spans_[i];
    if (!spans.empty() && spans.back().end == span.begin) {
      spans.back().end = span.end;
    } else if (!span.empty()) {
      spans.push_back(span);
    }
  }
  const std::vector<ColumnSpan>& of(int i) const { return spans_[i]; }

 private:
  std::vector<std::vector<ColumnSpan>> spans_;
};

/// Calls use(span) with the spans of disparity range.min + i; without `spans`, with all columns whose
/// match lies inside of the right image.
template <typename Use>
void forSpans(const RowSpans* spans, int width, const DisparityRange& range, int i,
              const Use& use) {
  if (spans == nullptr) {
    use(matchedColumns(width, range.min + i));
  } else {
    for (const ColumnSpan& span : spans->of(i)) {
      use(span);
    }
  }
}

/// Matching costs of all hypotheses of one image row, laid out [d][x] with x contiguous: for one d,
/// neighbours of both views are neighbours in memory. Line i stands for d = range.min + i; outside
/// of matchedColumns(width, d) its values are unspecified. `Cost` is the narrowest type that holds
/// a matcher's costs.
template <typename Cost>
class CostRow {
 public:
  void resize(int width, int disparities) {
    width_ = width;
    costs_.resize(static_cast<std::size_t>(width) * disparities);
  }
  Cost* line(int i) { return costs_.data() + static_cast<std::size_t>(i) * width_; }
  const Cost* line(int i) const { return costs_.data() + static_cast<std::size_t>(i) * width_; }

 private:
  int width_ = 0;
  std::vector<Cost> costs_;
};

/// A row of costs of any matcher.
using CostRowPointer = std::variant<const CostRow<std::uint8_t>*, const CostRow<std::uint16_t>*,
                                    const CostRow<float>*>;

}  // namespace cbmv
