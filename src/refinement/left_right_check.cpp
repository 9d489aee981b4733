#include "cbmv_stereo/refinement/left_right_check.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

namespace cbmv {
namespace {

/// What right pixels say of a left column, as bits.
constexpr std::uint8_t kAgrees = 1;   ///< at one of the disparities of the range
constexpr std::uint8_t kMatchOf = 2;  ///< of a right pixel whose disparity lies inside of the range

/// The disparities of the right view along one row.
struct RightRow {
  const float* disparity;
  int width;
  DisparityRange range;
  float max_difference_px;

  bool agrees(int x, float left_disparity) const {
    const float exact = static_cast<float>(x) - left_disparity;
    if (!(exact > -0.5F && exact < static_cast<float>(width))) {
      return false;
    }
    const int below = static_cast<int>(exact);
    const int column = below + static_cast<int>(exact - static_cast<float>(below) >= 0.5F);
    return column < width && disparity[column] != range.invalid() &&
           std::abs(left_disparity - disparity[column]) <= max_difference_px;
  }

  /// Marks of a row of the left image, which are 0 before. Most right disparities are whole and
  /// inside of the range: then only the column that they match is marked, and those up to
  /// matchReach() beside it agree, too.
  void markRow(std::uint8_t* marks) const {
    const RightRow row = *this;  // a store of a byte may change any member
    const auto lowest = static_cast<float>(row.range.min);
    const auto highest = static_cast<float>(row.range.max());
    for (int column = 0; column < row.width; ++column) {
      const float d = row.disparity[column];
      const auto whole = static_cast<int>(std::min(std::max(d, lowest), highest));
      const int x = column + whole;
      if (static_cast<float>(whole) == d && d > lowest && d < highest && x >= 0 && x < row.width &&
          row.matchReach() >= 0) {
        marks[x] |= kMatchOf;
      } else {
        row.markAgreeing(column, marks);
      }
    }
  }

  /// −1: no column is marked as a match.
  int matchReach() const {
    return max_difference_px >= 0 && max_difference_px < 2 ? static_cast<int>(max_difference_px)
                                                           : -1;
  }

  /// Sets kAgrees for the left image's columns that agree with the right one's `column` at one
  /// of the range's whole disparities.
  void markAgreeing(int column, std::uint8_t* marks) const {
    const float d = disparity[column];
    const float lowest = d - max_difference_px;
    const float highest = d + max_difference_px;
    const auto min = static_cast<float>(range.min);
    const auto max = static_cast<float>(range.max());
    if (d == range.invalid() || !(lowest <= max + 1 && highest >= min - 1)) {
      return;
    }
    // Up to rounding, d' agrees if lowest ≤ d' ≤ highest: those beside are tried, too.
    const int first =
        std::max({column + static_cast<int>(std::max(lowest, min)) - 1, column + range.min, 0});
    const int last = std::min(
        {column + static_cast<int>(std::min(highest, max)) + 1, column + range.max(), width - 1});
    const float limit = max_difference_px;  // a store of a byte may change any member
    for (int x = first; x <= last; ++x) {
      const float difference = std::abs(static_cast<float>(x - column) - d);
      marks[x] |= difference <= limit ? kAgrees : 0;
    }
  }
};

/// `labels` holds the marks of the row and becomes its labels.
void labelRow(const float* left, const RightRow& right, std::uint8_t* labels) {
  const bool reaches_neighbours = right.matchReach() == 1;
  std::uint8_t before = 0;
  for (int x = 0; x < right.width; ++x) {
    const std::uint8_t here = labels[x];
    const std::uint8_t after = x + 1 < right.width ? labels[x + 1] : std::uint8_t{0};
    const int beside = reaches_neighbours ? (before | after) & kMatchOf : 0;
    const Label other = (here | beside) == 0 ? kOcclusion : kMismatch;
    labels[x] = left[x] != right.range.invalid() && right.agrees(x, left[x]) ? kMatch : other;
    before = here;
  }
}

}  // namespace

void leftRightCheck(const cv::Mat& left_disparity, const cv::Mat& right_disparity,
                    const DisparityRange& range, float max_difference_px, cv::Mat& labels) {
  CV_Assert(left_disparity.type() == CV_32FC1 && right_disparity.type() == CV_32FC1);
  CV_Assert(left_disparity.size() == right_disparity.size());
  labels.create(left_disparity.size(), CV_8UC1);
  tbb::parallel_for(tbb::blocked_range<int>(0, labels.rows), [&](const auto& rows) {
    for (int y = rows.begin(); y != rows.end(); ++y) {
      const auto* left = left_disparity.ptr<float>(y);
      const RightRow right{right_disparity.ptr<float>(y), labels.cols, range, max_difference_px};
      auto* out = labels.ptr<std::uint8_t>(y);
      std::fill_n(out, labels.cols, 0);
      right.markRow(out);
      labelRow(left, right, out);
    }
  });
}

}  // namespace cbmv
