#include "cbmv_stereo/refinement/interpolation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "cbmv_stereo/refinement/left_right_check.h"

namespace cbmv {
namespace {

constexpr int kDirections = 16;
constexpr int kQuarter = kDirections / 4;

/// A ray from a pixel, walked in steps of one pixel along the image axis that it is closer to.
struct Ray {
  cv::Point along;   ///< that axis
  cv::Point aside;   ///< the other one
  double slope = 0;  ///< pixels aside a step along
};

/// Rays at k · 22.5°, from the x axis to the y axis.
std::array<Ray, kDirections> makeRays() {
  const cv::Point axes[] = {{1, 0}, {0, 1}, {-1, 0}, {0, -1}, {1, 0}};
  std::array<Ray, kDirections> rays;
  for (int k = 0; k < kDirections; ++k) {
    const cv::Point& before = axes[k / kQuarter];
    const cv::Point& after = axes[k / kQuarter + 1];
    const int turn = k % kQuarter;
    const int from_nearer = std::min(turn, kQuarter - turn);
    rays[k] = {2 * turn <= kQuarter ? before : after, 2 * turn <= kQuarter ? after : before,
               std::tan(2 * CV_PI * from_nearer / kDirections)};
  }
  return rays;
}

/// The nearest match on the ray from `start`; null when it leaves the image without one.
const float* nearestMatch(const cv::Mat& labels, const cv::Mat& disparity, const cv::Point& start,
                          const Ray& ray) {
  cv::Point axis = start;
  double aside = 0.5;  // rounds to the nearest pixel
  for (;;) {
    axis += ray.along;
    aside += ray.slope;
    const int x = axis.x + static_cast<int>(aside) * ray.aside.x;
    const int y = axis.y + static_cast<int>(aside) * ray.aside.y;
    if (x < 0 || x >= labels.cols || y < 0 || y >= labels.rows) {
      return nullptr;
    }
    if (labels.at<std::uint8_t>(y, x) == kMatch) {
      return disparity.ptr<float>(y) + x;
    }
  }
}

float medianOfNearest(const cv::Mat& labels, const cv::Mat& disparity, const cv::Point& pixel,
                      const std::array<Ray, kDirections>& rays, float without_match) {
  std::array<float, kDirections> nearest;
  int count = 0;
  for (const Ray& ray : rays) {
    if (const float* match = nearestMatch(labels, disparity, pixel, ray)) {
      nearest[count++] = *match;
    }
  }
  if (count == 0) {
    return without_match;
  }
  const auto median = nearest.begin() + (count - 1) / 2;
  std::nth_element(nearest.begin(), median, nearest.begin() + count);
  return *median;
}

void checkMaps(const cv::Mat& labels, const cv::Mat& disparity) {
  CV_Assert(labels.type() == CV_8UC1 && disparity.type() == CV_32FC1);
  CV_Assert(labels.size() == disparity.size());
}

void fillOcclusionsOfRow(const std::uint8_t* labels, int width, float without_match,
                         float* disparity) {
  const std::uint8_t* first_match = std::find(labels, labels + width, kMatch);
  const bool any_match = first_match != labels + width;
  float background = any_match ? disparity[first_match - labels] : without_match;
  for (int x = 0; x < width; ++x) {
    if (labels[x] == kMatch) {
      background = disparity[x];
    } else if (labels[x] == kOcclusion) {
      disparity[x] = background;
    }
  }
}

}  // namespace

void fillOcclusions(const cv::Mat& labels, const DisparityRange& range, cv::Mat& disparity) {
  checkMaps(labels, disparity);
  tbb::parallel_for(0, labels.rows, [&](int y) {
    fillOcclusionsOfRow(labels.ptr<std::uint8_t>(y), labels.cols, range.invalid(),
                        disparity.ptr<float>(y));
  });
}

void fillMismatches(const cv::Mat& labels, const DisparityRange& range, cv::Mat& disparity) {
  checkMaps(labels, disparity);
  const auto rays = makeRays();
  // Rows can be filled in parallel: only matches are read, and they are never written.
  tbb::parallel_for(tbb::blocked_range<int>(0, labels.rows), [&](const auto& rows) {
    for (int y = rows.begin(); y != rows.end(); ++y) {
      auto* out = disparity.ptr<float>(y);
      for (int x = 0; x < labels.cols; ++x) {
        if (labels.at<std::uint8_t>(y, x) == kMismatch) {
          out[x] = medianOfNearest(labels, disparity, {x, y}, rays, range.invalid());
        }
      }
    }
  });
}

}  // namespace cbmv
