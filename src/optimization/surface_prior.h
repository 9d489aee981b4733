#pragma once

#include <array>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include <opencv2/core.hpp>

namespace cbmv {

/// Value of a surface map where no surface is known.
constexpr std::int16_t kNoSurface = -32768;

/// Rise of the surface between two pixels. If the difference is more than one disparity, the pixels
/// probably belong to different surfaces, and the rise is 0.
inline std::int8_t surfaceRise(std::int16_t previous, std::int16_t next) {
  const int rise = next - previous;
  return previous != kNoSurface && next != kNoSurface && std::abs(rise) <= 1
             ? static_cast<std::int8_t>(rise)
             : std::int8_t{0};
}

/// Finds the slanted surfaces of a scene in a disparity map of half its size (surface orientation
/// priors, Scharstein, Taniai and Sinha 2017). SGM can follow these surfaces. Without them, it
/// turns slanted surfaces into stairs. The object keeps its memory.
///
/// - A plane is fitted around every cell of 4 × 4 coarse pixels by weighted least squares. There
///   are three fits.
/// - The weight of a pixel decreases with its distance: recursive exponential filters run over
///   the sums of the cells.
/// - In the second and third fit, the weight of a pixel is multiplied by (1 + r² / s²)⁻², with
///   s = 2 and s = 1. r is the distance in px from the surface of the previous fit.
/// - A cell has a surface if 60 % of the disparities around it, weighted by distance, are within
///   1 px of the surface of the previous fit.
/// - The planes of the four cells around a pixel are blended bilinearly. If one of these cells
///   has no surface, the pixel has none.
class SurfacePrior {
 public:
  /// Sets `surface` to a CV_16SC1 map of `size`, which is twice the size of `coarse` or one pixel
  /// more: the disparity of the surface, rounded to whole pixels of this size, or kNoSurface.
  /// `coarse` is CV_32FC1 in coarse px; values equal to `invalid` are ignored. `reach_px` is the
  /// standard deviation of the distance weights in px of `size`; it is positive. Parallel over rows
  /// by oneTBB. The result does not depend on the number of threads or earlier maps.
  void estimate(const cv::Mat& coarse, float invalid, float reach_px, const cv::Size& size,
                cv::Mat& surface);

 private:
  /// Weighted sums over the pixels of a cell: 1, x, y, x², xy, y², d, xd, yd. The last two are
  /// without the residual weights: the number of pixels with a disparity, and how many of these are
  /// near the surface.
  using Sums = std::array<float, 11>;

  struct Plane {
    float slope_x = 0;
    float slope_y = 0;
    float offset = 0;
    bool known = false;
  };

  /// Computes the sums. With scale_px = 0, all pixels have the same weight.
  void sumUp(const cv::Mat& coarse, float invalid, float scale_px);
  void smooth(float reach_cells);
  void fitPlanes(float lowest_inlier_share);
  bool surfaceAt(float x, float y, float& disparity) const;

  cv::Size grid_;
  std::vector<Sums> cells_;    ///< row by row
  std::vector<Plane> planes_;  ///< per cell
};

}  // namespace cbmv
