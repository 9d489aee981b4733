#pragma once

#include <opencv2/core.hpp>

#include "cbmv_stereo/disparity_range.h"
#include "cbmv_stereo/export.h"
#include "cbmv_stereo/options.h"

namespace cbmv {

/// The vertical misalignment that is left in a rectified pair, as a quadratic model
///   dy(x, y) = offset_px + slope_x u + slope_y v + twist u v + curvature_x u² + curvature_y v²,
///   u = x − (W−1)/2, v = y − (H−1)/2,
/// dy = row of a point in the right image minus its row in the left image. x is the column of the
/// point in the RIGHT image and y its row in the LEFT one: exactly what resampling the right image
/// needs, whatever the disparity. A camera that was turned by small angles a (pitch), b (yaw), c
/// (roll) has dy = f a + c u + (b/f) u v + (a/f) v² (Longuet-Higgins & Prazdny 1980); slope_y is a
/// difference in focal length, and lens distortion that is left bends all of them.
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
  double residual_px = 0.0;        ///< robust standard deviation of dy about the model
  int matches = 0;  ///< matches that agree with the model; 0 when there is no estimate

  /// dy in px at column x and row y of images of `size`.
  double at(double x, double y, cv::Size size) const;

  /// Root mean square of dy over images of `size`, px.
  double rootMeanSquare(cv::Size size) const;

  /// Makes it the zero model; what is known of the matches stays.
  void clearCorrection();

  /// Whether the model corrects nothing.
  bool isZero() const;
};

/// What one pair tells of the vertical offset, whether it is worth correcting or not.
struct VerticalOffsetMeasurement {
  VerticalOffset model;         ///< as fitted; matches = 0: nothing could be measured
  bool is_significant = false;  ///< differs from the zero model with 99.9 % confidence
  /// Root mean square of dy over the matches that agree with the model, in px.
  double rms_before_px = 0.0;
  double rms_after_px = 0.0;  ///< the same of what is left when the model is taken off
};

/// Fits the model to sparse matches between two CV_8UC1 images of one size (design: the authors of
/// CBMV refine the rectification before matching, their paper does not describe how).
///
/// Corners of the left image are searched in the right one at half resolution by normalised
/// cross-correlation, over the disparities of `range` and the rows allowed by the options, and kept
/// where the best place is unique; least squares on patches then gives each dy to sub-pixel
/// precision; a robust fit of the model (offset_fit.h beside the source) does the rest.
///
/// matches = 0: options.enabled is false, too few matches agree, or they scatter. Deterministic,
/// one thread. Throws Error when the images differ in size or are not CV_8UC1.
CBMV_API VerticalOffsetMeasurement measureVerticalOffset(const cv::Mat& left, const cv::Mat& right,
                                                         const DisparityRange& range,
                                                         const RectificationOptions& options);

/// The model to correct images of `size` by: the measured one, or the zero model (with what is
/// known of the matches) where the correction would be smaller than options.min_correction_px or
/// than its uncertainty.
CBMV_API VerticalOffset toCorrection(const VerticalOffsetMeasurement& measurement, cv::Size size,
                                     const RectificationOptions& options);

/// The correction that measureVerticalOffset leads to.
CBMV_API VerticalOffset estimateVerticalOffset(const cv::Mat& left, const cv::Mat& right,
                                               const DisparityRange& range,
                                               const RectificationOptions& options);

/// Resamples the right image (CV_8UC1 or CV_8UC3) so that matches lie on equal rows: row y of the
/// result is the right image at row y + dy(x, y), rounded to 1/32 px, by cubic interpolation along
/// the column (cubic convolution with a = −0.75, as OpenCV has it); rows beyond the border repeat
/// it. Returns `right` itself, without a copy, when the model is zero, else a map that shares the
/// memory of `aligned`, which is reused. Parallel over rows by oneTBB.
CBMV_API cv::Mat alignRightRows(const cv::Mat& right, const VerticalOffset& model,
                                cv::Mat& aligned);

/// The same into new memory.
CBMV_API cv::Mat alignRightRows(const cv::Mat& right, const VerticalOffset& model);

}  // namespace cbmv
