#pragma once

#include <array>
#include <cstddef>

#include <opencv2/core.hpp>

namespace cbmv {

inline constexpr double kErrorBinPx = 0.25;    ///< bin width of DisparityError::histogram
inline constexpr std::size_t kErrorBins = 16;  ///< up to 4 px

/// Errors over the counted pixels; all zero when there are none.
struct DisparityError {
  double bad_05 = 0.0;      ///< percent of the counted pixels with |d − truth| > 0.5 px or no d
  double bad_1 = 0.0;       ///< the same with 1 px
  double bad_2 = 0.0;       ///< the same with 2 px
  double bad_3 = 0.0;       ///< the same with 3 px
  double bad_4 = 0.0;       ///< the same with 4 px
  double d1 = 0.0;          ///< the same with both limits 3 px and 5 % of |truth| (KITTI 2015)
  double average_px = 0.0;  ///< mean of |d − truth| over pixels with a disparity
  double rms_px = 0.0;      ///< RMS of d − truth over pixels with a disparity
  double a50_px = 0.0;      ///< median of |d − truth| over pixels with a disparity
  double a90_px = 0.0;      ///< 90 % quantile of the same
  double a99_px = 0.0;      ///< 99 % quantile of the same
  double density = 0.0;     ///< percent of the counted pixels that have a disparity
  long pixels = 0;          ///< counted pixels: finite truth and mask 255
  /// Percent of the counted pixels with k · kErrorBinPx < |d − truth| ≤ (k + 1) · kErrorBinPx; bin
  /// 0 includes 0. Last element: above 4 px or no d.
  std::array<double, kErrorBins + 1> histogram{};
};

/// Compares `disparity` with `truth` (both CV_32FC1) where `mask` (CV_8UC1) is 255 and the truth is
/// finite. A pixel that equals `invalid` or is not finite has no disparity: it is bad at every
/// threshold and excluded from average, RMS and quantiles. Throws Error when the sizes differ or a
/// type is wrong.
DisparityError evaluateDisparity(const cv::Mat& disparity, const cv::Mat& truth,
                                 const cv::Mat& mask, float invalid);

}  // namespace cbmv
