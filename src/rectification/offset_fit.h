#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include "cbmv_stereo/vertical_offset.h"

namespace cbmv {

/// One point seen by both cameras.
struct SparseMatch {
  double x_right;  ///< column in the right image, px
  double y_left;   ///< row in the left image, px
  double dy;       ///< row in the right image minus row in the left one, px
};

/// Fits the model to matches of images of `size` (both sides > 1 px), some of which may be wrong:
/// starts from the least median of squares, without the curvatures, and ends by iteratively
/// reweighted least squares with Tukey's biweight. With VerticalOffset::kParameters matches or
/// more.
///
/// The standard deviations come from the covariance of this M-estimator (Huber, Robust Statistics,
/// section 7.6), H⁻¹ M H⁻¹ n / (n − 6) with H = Σ ψ'(r/s) a aᵀ, M = s² Σ ψ(r/s)² a aᵀ, where r are
/// the residuals, s their robust scale, a = (1, x, y, xy, x², y²) and ψ(u) = u (1 − (u/4.685)²)² up
/// to |u| = 4.685. This holds for errors that are independent from match to match; to the variance
/// of each parameter, at the border of the image, (0.015 px)² is added for what all matches of a
/// pair have in common: interpolation and aliasing.
VerticalOffsetMeasurement fitVerticalOffset(const std::vector<SparseMatch>& matches, cv::Size size);

}  // namespace cbmv
