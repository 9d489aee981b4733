#include "optimization/surface_prior.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include <tbb/parallel_for.h>

namespace cbmv {
namespace {

constexpr int kCell = 4;  // coarse pixels
constexpr float kWideScale = 2.0F;
constexpr float kNarrowScale = 1.0F;
constexpr float kInlierResidual = 1.0F;
constexpr float kInlierShare = 0.6F;
/// Number of filter runs: the kernel of one run has a sharp peak, the kernel of two runs is smooth.
constexpr int kSmoothingRuns = 2;
/// Added to the variance of the coordinates, in square pixels. Regularizes fits to a few collinear
/// pixels.
constexpr float kRidge = 0.01F;

enum Sum { kWeight, kX, kY, kXX, kXY, kYY, kD, kXD, kYD, kPixels, kInliers };

float residualWeight(float residual, float scale) {
  const float ratio = residual / scale;
  const float weight = 1.0F / (1.0F + ratio * ratio);
  return weight * weight;
}

/// Moves `sums` toward the neighbor's sums.
template <typename Sums>
void blend(const Sums& neighbor, float share, Sums& sums) {
  for (std::size_t i = 0; i < sums.size(); ++i) {
    sums[i] += share * (neighbor[i] - sums[i]);
  }
}

/// Recursive filter, forward and backward, along `count` cells that are `stride` apart.
template <typename Sums>
void smoothLine(Sums* line, int count, std::ptrdiff_t stride, float share) {
  for (int i = 1; i < count; ++i) {
    blend(line[(i - 1) * stride], share, line[i * stride]);
  }
  for (int i = count - 2; i >= 0; --i) {
    blend(line[(i + 1) * stride], share, line[i * stride]);
  }
}

}  // namespace

void SurfacePrior::estimate(const cv::Mat& coarse, float invalid, float reach_px,
                            const cv::Size& size, cv::Mat& surface) {
  CV_Assert(coarse.type() == CV_32FC1 && size.width / 2 == coarse.cols &&
            size.height / 2 == coarse.rows && reach_px > 0);
  grid_ = cv::Size((coarse.cols + kCell - 1) / kCell, (coarse.rows + kCell - 1) / kCell);
  cells_.resize(grid_.area());
  planes_.resize(grid_.area());
  const float reach_cells = reach_px / (2 * kCell);
  for (const float scale : {0.0F, kWideScale, kNarrowScale}) {
    sumUp(coarse, invalid, scale);
    smooth(reach_cells);
    fitPlanes(scale == kNarrowScale ? kInlierShare : 0);
  }
  surface.create(size, CV_16SC1);
  tbb::parallel_for(0, size.height, [&](int y) {
    auto* out = surface.ptr<std::int16_t>(y);
    for (int x = 0; x < size.width; ++x) {
      float disparity = 0;
      const bool known = surfaceAt(0.5F * (x - 0.5F), 0.5F * (y - 0.5F), disparity);
      out[x] = known ? static_cast<std::int16_t>(
                           std::lround(std::clamp(2 * disparity, kNoSurface + 1.0F, 32767.0F)))
                     : kNoSurface;
    }
  });
}

void SurfacePrior::sumUp(const cv::Mat& coarse, float invalid, float scale_px) {
  tbb::parallel_for(0, grid_.height, [&](int row) {
    Sums* cells = cells_.data() + static_cast<std::ptrdiff_t>(row) * grid_.width;
    std::fill_n(cells, grid_.width, Sums{});
    for (int y = row * kCell; y < std::min((row + 1) * kCell, coarse.rows); ++y) {
      const auto* disparities = coarse.ptr<float>(y);
      for (int x = 0; x < coarse.cols; ++x) {
        const float d = disparities[x];
        if (d == invalid) {
          continue;
        }
        float before = d;
        const bool known = scale_px == 0 || surfaceAt(x, y, before);
        const float w = !known ? 0 : scale_px == 0 ? 1 : residualWeight(d - before, scale_px);
        const bool inlier = known && std::abs(d - before) < kInlierResidual;
        const Sums terms = {w,     w * x,     w * y,     w * x * x, w * x * y,           w * y * y,
                            w * d, w * x * d, w * y * d, 1.0F,      inlier ? 1.0F : 0.0F};
        Sums& sums = cells[x / kCell];
        for (std::size_t i = 0; i < sums.size(); ++i) {
          sums[i] += terms[i];
        }
      }
    }
  });
}

void SurfacePrior::smooth(float reach_cells) {
  // The variances of the runs add up. The variance of e^(−a |x|) is 2 / a².
  const float share = std::exp(-std::sqrt(2.0F * kSmoothingRuns) / reach_cells);
  for (int run = 0; run < kSmoothingRuns; ++run) {
    for (int y = 0; y < grid_.height; ++y) {
      smoothLine(cells_.data() + static_cast<std::ptrdiff_t>(y) * grid_.width, grid_.width, 1,
                 share);
    }
    for (int x = 0; x < grid_.width; ++x) {
      smoothLine(cells_.data() + x, grid_.height, grid_.width, share);
    }
  }
}

void SurfacePrior::fitPlanes(float lowest_inlier_share) {
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    const Sums& sums = cells_[i];
    Plane& plane = planes_[i];
    plane.known = sums[kWeight] > 1e-4F && sums[kInliers] >= lowest_inlier_share * sums[kPixels];
    if (!plane.known) {
      continue;
    }
    const auto mean = [&sums](Sum sum) { return sums[sum] / sums[kWeight]; };
    const float xx = mean(kXX) - mean(kX) * mean(kX) + kRidge;
    const float xy = mean(kXY) - mean(kX) * mean(kY);
    const float yy = mean(kYY) - mean(kY) * mean(kY) + kRidge;
    const float xd = mean(kXD) - mean(kX) * mean(kD);
    const float yd = mean(kYD) - mean(kY) * mean(kD);
    const float determinant = xx * yy - xy * xy;
    plane.slope_x = (xd * yy - yd * xy) / determinant;
    plane.slope_y = (yd * xx - xd * xy) / determinant;
    plane.offset = mean(kD) - plane.slope_x * mean(kX) - plane.slope_y * mean(kY);
  }
}

bool SurfacePrior::surfaceAt(float x, float y, float& disparity) const {
  const auto cell_of = [](float position, int cells, int& first, int& second) {
    const float cell = std::clamp((position - 0.5F * (kCell - 1)) / kCell, 0.0F, cells - 1.0F);
    first = static_cast<int>(cell);
    second = std::min(first + 1, cells - 1);
    return cell - first;
  };
  int left = 0, right = 0, upper = 0, lower = 0;
  const float u = cell_of(x, grid_.width, left, right);
  const float v = cell_of(y, grid_.height, upper, lower);
  const auto value = [&](int row, int column, bool& known) {
    const Plane& plane = planes_[static_cast<std::size_t>(row) * grid_.width + column];
    known = known && plane.known;
    return plane.offset + plane.slope_x * x + plane.slope_y * y;
  };
  bool known = true;
  disparity = (1 - v) * ((1 - u) * value(upper, left, known) + u * value(upper, right, known)) +
              v * ((1 - u) * value(lower, left, known) + u * value(lower, right, known));
  return known;
}

}  // namespace cbmv
