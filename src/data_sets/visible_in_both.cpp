#include "data_sets/visible_in_both.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace cbmv {
namespace {

constexpr float kOccluderMargin = 1.0F;  // px of disparity
constexpr float kOccluderReach = 1.0F;   // columns of the right image

/// A pixel with known disparity and its column in the right image.
struct Landing {
  float column;
  float disparity;
  int x;
};

/// The landings of one row, sorted by column.
std::vector<Landing> landings(const cv::Mat& truth, int y) {
  std::vector<Landing> row;
  for (int x = 0; x < truth.cols; ++x) {
    const float d = truth.at<float>(y, x);
    if (std::isfinite(d)) {
      row.push_back({static_cast<float>(x) - d, d, x});
    }
  }
  std::sort(row.begin(), row.end(),
            [](const Landing& a, const Landing& b) { return a.column < b.column; });
  return row;
}

bool isHidden(const std::vector<Landing>& row, std::size_t i, int width) {
  const Landing& pixel = row[i];
  if (pixel.column < -0.5F || pixel.column > static_cast<float>(width) - 0.5F) {
    return true;
  }
  const auto near = [&](std::size_t j) {
    return std::abs(row[j].column - pixel.column) < kOccluderReach;
  };
  std::size_t j = i;
  while (j > 0 && near(j - 1)) {
    --j;
  }
  for (; j < row.size() && near(j); ++j) {
    if (row[j].disparity > pixel.disparity + kOccluderMargin) {
      return true;
    }
  }
  return false;
}

}  // namespace

cv::Mat visibleInBoth(const cv::Mat& truth) {
  CV_Assert(truth.type() == CV_32FC1);
  cv::Mat visible(truth.size(), CV_8UC1, cv::Scalar(0));
  for (int y = 0; y < truth.rows; ++y) {
    const std::vector<Landing> row = landings(truth, y);
    for (std::size_t i = 0; i < row.size(); ++i) {
      visible.at<uchar>(y, row[i].x) = isHidden(row, i, truth.cols) ? 0 : 255;
    }
  }
  return visible;
}

}  // namespace cbmv
