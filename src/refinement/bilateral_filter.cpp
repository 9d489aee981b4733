#include "cbmv_stereo/refinement/bilateral_filter.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "cbmv_stereo/error.h"

namespace cbmv {
namespace {

/// Weighted sums over the windows of a row of pixels. Of differences to the centre, because they
/// are small and float loses little of them.
struct RowSums {
  explicit RowSums(int width) : differences(width), weights(width) {}

  void reset() {
    std::fill(differences.begin(), differences.end(), 0.0F);
    std::fill(weights.begin(), weights.end(), 0.0F);
  }

  /// Adds the neighbour of each centre, all in the same direction and thus of the same weight.
  void add(const float* __restrict neighbours, const float* __restrict centres, float weight,
           float threshold_px) {
    float* __restrict difference_sums = differences.data();
    float* __restrict weight_sums = weights.data();
    const auto width = static_cast<int>(differences.size());
    for (int x = 0; x < width; ++x) {
      const float difference = neighbours[x] - centres[x];
      const bool near = std::abs(difference) < threshold_px;
      difference_sums[x] += near ? weight * difference : 0.0F;
      weight_sums[x] += near ? weight : 0.0F;
    }
  }

  std::vector<float> differences;
  std::vector<float> weights;
};

/// The disparities with a border of `radius` pixels, far away from every threshold at the border
/// and at invalid pixels, so that no window needs a test for either.
cv::Mat padded(const cv::Mat& disparity, float invalid, int radius) {
  const float far = std::numeric_limits<float>::infinity();
  cv::Mat result(disparity.rows + 2 * radius, disparity.cols + 2 * radius, CV_32FC1, far);
  for (int y = 0; y < disparity.rows; ++y) {
    const auto* in = disparity.ptr<float>(y);
    std::replace_copy(in, in + disparity.cols, result.ptr<float>(y + radius) + radius, invalid,
                      far);
  }
  return result;
}

class BilateralFilter {
 public:
  BilateralFilter(const cv::Mat& disparity, float invalid, float sigma_px, float threshold_px)
      : invalid_(invalid),
        threshold_px_(threshold_px),
        radius_(static_cast<int>(std::ceil(3 * sigma_px))),
        padded_(padded(disparity, invalid, radius_)) {
    for (int offset = 0; offset <= radius_; ++offset) {
      weights_.push_back(
          std::exp(-static_cast<float>(offset * offset) / (2 * sigma_px * sigma_px)));
    }
  }

  void filterRow(int y, RowSums& sums, float* out) const {
    const auto* centres = padded_.ptr<float>(y + radius_) + radius_;
    sums.reset();
    for (int dy = -radius_; dy <= radius_; ++dy) {
      const auto* row = padded_.ptr<float>(y + radius_ + dy) + radius_;
      for (int dx = -radius_; dx <= radius_; ++dx) {
        sums.add(row + dx, centres, weights_[std::abs(dy)] * weights_[std::abs(dx)], threshold_px_);
      }
    }
    const auto width = static_cast<int>(sums.weights.size());
    for (int x = 0; x < width; ++x) {
      const bool valid = sums.weights[x] > 0;  // else even the centre was far away from itself
      out[x] = valid ? centres[x] + sums.differences[x] / sums.weights[x] : invalid_;
    }
  }

 private:
  float invalid_;
  float threshold_px_;
  int radius_;
  cv::Mat padded_;
  std::vector<float> weights_;  // of either axis: a Gaussian is separable
};

void checkOptions(float sigma_px, float threshold_px) {
  if (!(sigma_px >= 0)) {
    throw Error("The sigma of the bilateral filter is " + std::to_string(sigma_px) +
                " px; it must be 0 (no filter) or positive.");
  }
  if (!(threshold_px > 0)) {
    throw Error("The threshold of the bilateral filter is " + std::to_string(threshold_px) +
                " px; it must be positive.");
  }
}

}  // namespace

void bilateralFilter(const cv::Mat& disparity, const DisparityRange& range, float sigma_px,
                     float threshold_px, cv::Mat& filtered) {
  CV_Assert(disparity.type() == CV_32FC1 && disparity.data != filtered.data);
  checkOptions(sigma_px, threshold_px);
  if (sigma_px == 0) {
    disparity.copyTo(filtered);
    return;
  }
  filtered.create(disparity.size(), CV_32FC1);
  const BilateralFilter filter(disparity, range.invalid(), sigma_px, threshold_px);
  tbb::parallel_for(tbb::blocked_range<int>(0, disparity.rows), [&](const auto& rows) {
    RowSums sums(disparity.cols);
    for (int y = rows.begin(); y != rows.end(); ++y) {
      filter.filterRow(y, sums, filtered.ptr<float>(y));
    }
  });
}

}  // namespace cbmv
