#pragma once

#include <opencv2/core.hpp>

#include "cbmv_stereo/disparity_range.h"
#include "cbmv_stereo/export.h"
#include "cbmv_stereo/options.h"

namespace cbmv {

/// The residual vertical offset of a rectified pair, as a quadratic model:
///   dy(x, y) = offset_px + slope_x u + slope_y v + twist u v + curvature_x u² + curvature_y v²,
///   u = x − (W−1)/2, v = y − (H−1)/2.
/// dy is the row of a point in the right image minus its row in the left image. x is the column of
/// the point in the RIGHT image, y is its row in the LEFT image. Resampling the right image needs
/// this form at every disparity.
///
/// A camera that is turned by small angles a (pitch), b (yaw), c (roll) has
///   dy = f a + c u + (b/f) u v + (a/f) v² (Longuet-Higgins & Prazdny 1980).
/// slope_y is a difference of the focal lengths. Residual lens distortion changes all terms.
struct CBMV_API VerticalOffset {
  static constexpr int kParameters = 6;

  double offset_px = 0.0;
  double slope_x = 0.0;            ///< px per column
  double slope_y = 0.0;            ///< px per row
  double twist = 0.0;              ///< px per column and row
  double curvature_x = 0.0;        ///< px per column²
  double curvature_y = 0.0;        ///< px per row²
  double offset_sigma_px = 0.0;    ///< standard deviation of offset_px
  double slope_x_sigma = 0.0;      ///< standard deviation of slope_x, px per column
  double slope_y_sigma = 0.0;      ///< standard deviation of slope_y, px per row
  double twist_sigma = 0.0;        ///< standard deviation of twist, px per column and row
  double curvature_x_sigma = 0.0;  ///< standard deviation of curvature_x, px per column²
  double curvature_y_sigma = 0.0;  ///< standard deviation of curvature_y, px per row²
  double residual_px = 0.0;        ///< robust standard deviation of the residuals of dy
  int matches = 0;                 ///< matches that agree with the model; 0: no estimate

  /// Returns dy in px at column x and row y of images of `size`.
  double at(double x, double y, cv::Size size) const;

  /// Returns the root mean square of dy over images of `size`, in px.
  double rootMeanSquare(cv::Size size) const;

  /// Sets the model to zero. The fields about the matches are kept.
  void clearCorrection();

  /// Returns whether the model corrects nothing.
  bool isZero() const;
};

/// The residual vertical offset measured in one pair, whether or not it is worth correcting.
struct VerticalOffsetMeasurement {
  VerticalOffset model;         ///< as fitted; matches = 0: no measurement
  bool is_significant = false;  ///< differs from the zero model with 99.9 % confidence
  /// Root mean square of dy over the matches that agree with the model, in px.
  double rms_before_px = 0.0;
  double rms_after_px = 0.0;  ///< the same after subtracting the model
};

/// Fits the model to sparse matches between two CV_8UC1 images of the same size. The design is our
/// own: the authors of CBMV refine the rectification before matching, but their paper does not
/// describe how.
///
/// 1. Corners of the left image are searched in the right image at half resolution by normalized
///    cross-correlation, over the disparities of `range` and the rows allowed by the options.
///    A match is kept if its maximum is unique.
/// 2. Least squares on patches gives each dy with subpixel precision.
/// 3. A robust fit gives the model (rectification/offset_fit.h).
///
/// matches = 0 if options.enabled is false, too few matches agree, or they scatter. Deterministic,
/// one thread. Throws Error if the images differ in size or are not CV_8UC1.
CBMV_API VerticalOffsetMeasurement measureVerticalOffset(const cv::Mat& left, const cv::Mat& right,
                                                         const DisparityRange& range,
                                                         const RectificationOptions& options);

/// Returns the rectification correction for images of `size`. This is the measured model, unless
/// its correction is smaller than options.min_correction_px or than its uncertainty. Then it is the
/// zero model, which keeps the fields about the matches.
CBMV_API VerticalOffset toCorrection(const VerticalOffsetMeasurement& measurement, cv::Size size,
                                     const RectificationOptions& options);

/// Measures the pair and returns its rectification correction (toCorrection).
CBMV_API VerticalOffset estimateVerticalOffset(const cv::Mat& left, const cv::Mat& right,
                                               const DisparityRange& range,
                                               const RectificationOptions& options);

/// Applies a rectification correction: resamples the right image (CV_8UC1 or CV_8UC3) so that
/// matches lie on equal rows. Row y of the result is the right image at row y + dy(x, y), rounded
/// to 1/32 px. Interpolation is cubic along the column (cubic convolution with a = −0.75, as in
/// OpenCV). Rows beyond the border repeat the border row. Returns `right` itself without a copy if
/// the model is zero, otherwise a map that shares the memory of `aligned`, which is reused.
/// Parallel over rows by oneTBB.
CBMV_API cv::Mat alignRightRows(const cv::Mat& right, const VerticalOffset& model,
                                cv::Mat& aligned);

/// The same, but into new memory.
CBMV_API cv::Mat alignRightRows(const cv::Mat& right, const VerticalOffset& model);

}  // namespace cbmv
