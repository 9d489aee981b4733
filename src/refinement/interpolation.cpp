#include "cbmv_stereo/refinement/interpolation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "cbmv_stereo/refinement/left_right_check.h"

namespace cbmv {
namespace {

constexpr int kDirections = 16;

/// Pixels of a ray that starts at the origin, nearest first, without the origin itself.
using Ray = std::vector<cv::Point>;

/// Rays of `length` steps, each one pixel along the axis that the ray is closer to.
std::array<Ray, kDirections> makeRays(int length) {
  std::array<Ray, kDirections> rays;
  for (int k = 0; k < kDirections; ++k) {
    const double angle = 2 * CV_PI * k / kDirections;
    const double scale = 1 / std::max(std::abs(std::cos(angle)), std::abs(std::sin(angle)));
    for (int step = 1; step <= length; ++step) {
      rays[k].emplace_back(static_cast<int>(std::lround(step * scale * std::cos(angle))),
                           static_cast<int>(std::lround(step * scale * std::sin(angle))));
    }
  }
  return rays;
}

/// The nearest match on the ray from `start`; null when it leaves the image without one.
const float* nearestMatch(const cv::Mat& labels, const cv::Mat& disparity, const cv::Point& start,
                          const Ray& ray) {
  const cv::Rect image(0, 0, labels.cols, labels.rows);
  for (const cv::Point& offset : ray) {
    const cv::Point pixel = start + offset;
    if (!image.contains(pixel)) {
      return nullptr;
    }
    if (labels.at<std::uint8_t>(pixel) == kMatch) {
      return disparity.ptr<float>(pixel.y) + pixel.x;
    }
  }
  return nullptr;
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
  for (int y = 0; y < labels.rows; ++y) {
    fillOcclusionsOfRow(labels.ptr<std::uint8_t>(y), labels.cols, range.invalid(),
                        disparity.ptr<float>(y));
  }
}

void fillMismatches(const cv::Mat& labels, const DisparityRange& range, cv::Mat& disparity) {
  checkMaps(labels, disparity);
  const auto rays = makeRays(std::max(labels.cols, labels.rows));
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
