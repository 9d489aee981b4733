#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include "cbmv_stereo/vertical_offset.h"

namespace cbmv {

/// One point seen by both cameras.
struct SparseMatch {
  double x_right;  ///< column in the right image, px
  double y_left;   ///< row in the left image, px
  double dy;       ///< row in the right image minus row in the left image, px
};

/// Fits the model to at least VerticalOffset::kParameters matches of images of `size` (both sides
/// above 1 px). Some matches may be wrong. Starts from the least median of squares without
/// curvatures, then runs iteratively reweighted least squares with Tukey's biweight.
///
/// The standard deviations are from the covariance of this M-estimator (Huber, Robust Statistics,
/// section 7.6):
///   H⁻¹ M H⁻¹ n / (n − 6) with H = Σ ψ'(r/s) a aᵀ, M = s² Σ ψ(r/s)² a aᵀ,
/// where r are the residuals, s is their robust scale, a = (1, x, y, xy, x², y²), and
///   ψ(u) = u (1 − (u/4.685)²)² up to |u| = 4.685.
/// It assumes that the errors of different matches are independent.
/// Interpolation and aliasing give all matches of a pair a common error. For it, (0.015 px)² is
/// added to the variance of each parameter, in px at the image border.
VerticalOffsetMeasurement fitVerticalOffset(const std::vector<SparseMatch>& matches, cv::Size size);

}  // namespace cbmv
