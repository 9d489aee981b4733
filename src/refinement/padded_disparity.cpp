#include "refinement/padded_disparity.h"

#include <algorithm>

#include <tbb/parallel_for.h>

namespace cbmv {

void padDisparity(const cv::Mat& disparity, float invalid, int radius, float filler,
                  cv::Mat& padded) {
  padded.create(disparity.rows + 2 * radius, disparity.cols + 2 * radius + kLongestVector,
                CV_32FC1);
  tbb::parallel_for(0, padded.rows, [&](int row) {
    auto* out = padded.ptr<float>(row);
    std::fill_n(out, padded.cols, filler);
    const int y = row - radius;
    if (y >= 0 && y < disparity.rows) {
      const auto* in = disparity.ptr<float>(y);
      std::replace_copy(in, in + disparity.cols, out + radius, invalid, filler);
    }
  });
}

}  // namespace cbmv
