#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

namespace cbmv {

/// In a surface map: no surface is known at the pixel.
constexpr std::int16_t kNoSurface = -32768;

/// Finds the slanted surfaces of a scene in a disparity map of half its size, so that semi-global
/// matching can follow them instead of taking them for flights of stairs (surface orientation
/// priors, Scharstein, Taniai and Sinha 2017). Holds the memory for that.
///
/// A plane is fitted around every cell of 4 × 4 coarse pixels by weighted least squares, three
/// times. The weight of a pixel falls with its distance: recursive exponential filters run over the
/// sums of the cells. The second and the third time a pixel that is r px off the surface of the
/// time before weighs (1 + r² / s²)⁻² of that, with s = 2 and 1. A cell has a surface where, of all
/// disparities around it, weighted by distance, 60 % are within 1 px of the surface of the time
/// before. The planes of the four cells around a pixel are blended bilinearly; where one of these
/// has no surface, the pixel has none.
class SurfacePrior {
 public:
  /// `coarse` is CV_32FC1, in coarse pixels; those equal to `invalid` do not count. `surface`
  /// becomes CV_16SC1 of `size`, twice that of `coarse` or one pixel more: the surface's disparity
  /// rounded to whole pixels of that size, or kNoSurface. `reach_px` is the standard deviation of
  /// the weights over distance, in pixels of `size`, positive. Parallel over rows by oneTBB; the
  /// result depends neither on the number of threads nor on earlier maps.
  void estimate(const cv::Mat& coarse, float invalid, float reach_px, const cv::Size& size,
                cv::Mat& surface);

 private:
  /// Weighted sums over the pixels of a cell: 1, x, y, x², xy, y², d, xd, yd; and, without the
  /// weights of residuals, how many have a disparity and how many of these are near the surface.
  using Sums = std::array<float, 11>;

  struct Plane {
    float slope_x = 0;
    float slope_y = 0;
    float offset = 0;
    bool known = false;
  };

  /// Sums up the pixels; with scale_px = 0 all weigh the same.
  void sumUp(const cv::Mat& coarse, float invalid, float scale_px);
  void smooth(float reach_cells);
  void fitPlanes(float lowest_inlier_share);
  bool surfaceAt(float x, float y, float& disparity) const;

  cv::Size grid_;
  std::vector<Sums> cells_;    ///< row by row
  std::vector<Plane> planes_;  ///< of the cells
};

}  // namespace cbmv
