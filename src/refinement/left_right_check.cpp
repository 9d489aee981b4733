#include "cbmv_stereo/refinement/left_right_check.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

namespace cbmv {
namespace {

/// The disparities of the right view along one row.
struct RightRow {
  const float* disparity;
  int width;
  DisparityRange range;
  float max_difference_px;

  bool agrees(int x, float left_disparity) const {
    const long column = std::lround(static_cast<float>(x) - left_disparity);
    return column >= 0 && column < width && disparity[column] != range.invalid() &&
           std::abs(left_disparity - disparity[column]) <= max_difference_px;
  }

  /// Looks at all disparities even if one agrees: this loop the compiler turns into vectors.
  bool agreesAnywhere(int x) const {
    const int first = std::max(x - range.max(), 0);
    const int last = std::min(x - range.min, width - 1);
    int agreeing = 0;
    for (int column = first; column <= last; ++column) {
      const float difference = std::abs(static_cast<float>(x - column) - disparity[column]);
      agreeing |= static_cast<int>(difference <= max_difference_px) &
                  static_cast<int>(disparity[column] != range.invalid());
    }
    return agreeing != 0;
  }
};

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
      for (int x = 0; x < labels.cols; ++x) {
        if (left[x] != range.invalid() && right.agrees(x, left[x])) {
          out[x] = kMatch;
        } else {
          out[x] = right.agreesAnywhere(x) ? kMismatch : kOcclusion;
        }
      }
    }
  });
}

}  // namespace cbmv
