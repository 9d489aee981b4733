#include "refinement/left_border.h"

#include <algorithm>
#include <cstdint>
#include <optional>

#include <tbb/parallel_for.h>

#include "refinement/border_rows.h"
#include "refinement/left_right_check.h"

namespace cbmv {
namespace {

constexpr int kRightColumns = 5;
constexpr float kTolerancePx = 4;
// Fraction of the width, from the border of the right image.
constexpr float kFarthestMatch = 1.0F / 16;

/// The last left column that the first right columns of a row match. Empty if they have no match.
std::optional<float> lastMatchedColumn(const float* right_disparity, int width, float invalid) {
  std::optional<float> last;
  for (int x = 0; x < std::min(kRightColumns, width); ++x) {
    const float column = static_cast<float>(x) + right_disparity[x];
    if (right_disparity[x] != invalid && (!last || column > *last)) {
      last = column;
    }
  }
  return last;
}

void occludeRow(const float* left_disparity, int width, float end, std::uint8_t* labels) {
  const float farthest = kFarthestMatch * static_cast<float>(width);
  for (int x = 0; x < width && static_cast<float>(x) < end; ++x) {
    const float match = static_cast<float>(x) - left_disparity[x];
    labels[x] = labels[x] == kMatch && match > farthest ? kMatch : kOcclusion;
  }
}

}  // namespace

void occludeLeftBorder(const cv::Mat& left_disparity, const cv::Mat& right_disparity,
                       const DisparityRange& range, cv::Mat& labels) {
  CV_Assert(left_disparity.type() == CV_32FC1 && right_disparity.type() == CV_32FC1);
  CV_Assert(labels.type() == CV_8UC1 && left_disparity.size() == labels.size());
  CV_Assert(right_disparity.size() == labels.size());
  tbb::parallel_for(0, labels.rows, [&](int y) {
    const std::optional<float> last = medianOfRows(y, labels.rows, [&](int row) {
      return lastMatchedColumn(right_disparity.ptr<float>(row), labels.cols, range.invalid());
    });
    occludeRow(left_disparity.ptr<float>(y), labels.cols, last.value_or(0) - kTolerancePx,
               labels.ptr<std::uint8_t>(y));
  });
}

}  // namespace cbmv
