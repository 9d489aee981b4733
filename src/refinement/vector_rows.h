#pragma once

#include <algorithm>
#include <vector>

#include <opencv2/core.hpp>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

namespace cbmv {

/// Floats of the longest vector that is used.
inline constexpr int kLongestVector = 16;

/// Fills the rows of `map` (CV_32FC1, allocated) by `write(y, row)`, which has room for a vector
/// behind the end of the row and so need not care for it. Parallel over rows by oneTBB.
template <typename Write>
void writeVectorRows(cv::Mat& map, const Write& write) {
  tbb::parallel_for(tbb::blocked_range<int>(0, map.rows), [&](const auto& rows) {
    std::vector<float> row(map.cols + kLongestVector);
    for (int y = rows.begin(); y != rows.end(); ++y) {
      write(y, row.data());
      std::copy_n(row.data(), map.cols, map.ptr<float>(y));
    }
  });
}

}  // namespace cbmv
