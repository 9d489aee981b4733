#pragma once

#include <cmath>
#include <string>

#include <opencv2/core.hpp>

#include "cbmv_stereo/error.h"

namespace cbmv {

/// Throws Error with the map's name unless it has the given size and type (CV_8UC1 or CV_32FC1).
inline void requireMap(const cv::Mat& map, const char* name, int type, const cv::Size& size) {
  if (map.type() != type || map.size() != size) {
    throw Error(std::string("Cannot evaluate a disparity map: ") + name +
                " must have the size of the disparity map and the type " +
                (type == CV_8UC1 ? "CV_8UC1." : "CV_32FC1."));
  }
}

inline bool hasDisparity(float disparity, float invalid) {
  return disparity != invalid && std::isfinite(disparity);
}

/// Calls `use(y, x)` row by row for every counted pixel: the mask is 255 and the truth is known.
template <typename Use>
void forCountedPixels(const cv::Mat& truth, const cv::Mat& mask, const Use& use) {
  for (int y = 0; y < truth.rows; ++y) {
    for (int x = 0; x < truth.cols; ++x) {
      if (mask.at<uchar>(y, x) == 255 && std::isfinite(truth.at<float>(y, x))) {
        use(y, x);
      }
    }
  }
}

}  // namespace cbmv
