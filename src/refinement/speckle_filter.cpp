#include "refinement/speckle_filter.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include <opencv2/calib3d.hpp>
#include <tbb/parallel_for.h>

namespace cbmv {
namespace {

constexpr float kStepsPerPx = 16;
constexpr float kMostSteps = 32000;
constexpr std::int16_t kNone = std::numeric_limits<std::int16_t>::min();

float stepsPerPx(const DisparityRange& range) {
  return std::min(kStepsPerPx, kMostSteps / static_cast<float>(range.count));
}

/// Converts disparities to integer steps from the lower end of the range, so that ranges below 0
/// fit too.
void toSteps(const cv::Mat& disparity, const DisparityRange& range, cv::Mat& steps) {
  const float scale = stepsPerPx(range);
  const auto lowest = static_cast<float>(range.min);
  const float invalid = range.invalid();
  steps.create(disparity.size(), CV_16SC1);
  tbb::parallel_for(0, disparity.rows, [&](int y) {
    const auto* row = disparity.ptr<float>(y);
    std::transform(row, row + disparity.cols, steps.ptr<std::int16_t>(y), [=](float d) {
      const float step = std::floor((d - lowest) * scale + 0.5F);
      return d == invalid ? kNone : static_cast<std::int16_t>(step);
    });
  });
}

}  // namespace

void removeSpeckles(const DisparityRange& range, int size_px, int difference_px,
                    SpeckleBuffers& buffers, cv::Mat& disparity) {
  CV_Assert(disparity.type() == CV_32FC1);
  if (size_px <= 0) {
    return;
  }
  toSteps(disparity, range, buffers.steps);
  const double most = std::floor(static_cast<float>(difference_px) * stepsPerPx(range));
  cv::filterSpeckles(buffers.steps, kNone, size_px, most, buffers.regions);
  tbb::parallel_for(0, disparity.rows, [&](int y) {
    const auto* steps = buffers.steps.ptr<std::int16_t>(y);
    auto* row = disparity.ptr<float>(y);
    std::transform(row, row + disparity.cols, steps, row,
                   [&](float d, std::int16_t step) { return step == kNone ? range.invalid() : d; });
  });
}

}  // namespace cbmv
