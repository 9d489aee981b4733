#include "cbmv_stereo/optimization/support_arms.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "cbmv_stereo/error.h"

namespace cbmv {
namespace {

/// Pixels that an arm takes in when it grows from `centre` by `stride` elements at a time.
std::uint8_t armLength(const std::uint8_t* centre, std::ptrdiff_t stride, int limit,
                       int threshold) {
  int length = 0;
  while (length < limit && std::abs(centre[(length + 1) * stride] - *centre) < threshold) {
    ++length;
  }
  return static_cast<std::uint8_t>(length);
}

}  // namespace

void computeSupportArms(const cv::Mat& grey, int max_length, float threshold_grey, cv::Mat& arms) {
  CV_Assert(grey.type() == CV_8UC1);
  if (max_length < 1 || max_length > 255) {
    throw Error("The arm length of cost aggregation is " + std::to_string(max_length) +
                " px; it must be between 1 and 255.");
  }
  const cv::Mat image = grey;  // stays valid when `arms` is the same object
  arms.create(image.size(), CV_8UC4);
  // A whole number is below the threshold exactly when it is below the threshold rounded up.
  const int threshold = static_cast<int>(std::ceil(std::min(threshold_grey, 256.0F)));
  const int reach = max_length - 1;
  const auto stride = static_cast<std::ptrdiff_t>(image.step1());

  tbb::parallel_for(tbb::blocked_range<int>(0, image.rows), [&](const auto& rows) {
    for (int y = rows.begin(); y != rows.end(); ++y) {
      const auto* pixels = image.ptr<std::uint8_t>(y);
      auto* out = arms.ptr<cv::Vec4b>(y);
      const int reach_up = std::min(reach, y);
      const int reach_down = std::min(reach, image.rows - 1 - y);
      for (int x = 0; x < image.cols; ++x) {
        const std::uint8_t* centre = pixels + x;
        out[x] = {armLength(centre, -1, std::min(reach, x), threshold),
                  armLength(centre, 1, std::min(reach, image.cols - 1 - x), threshold),
                  armLength(centre, -stride, reach_up, threshold),
                  armLength(centre, stride, reach_down, threshold)};
      }
    }
  });
}

}  // namespace cbmv
