#pragma once

#include <opencv2/core.hpp>

#include "cbmv_stereo/disparity_range.h"
#include "cbmv_stereo/options.h"

namespace cbmv {

/// The maps that are refined. All have the same size.
struct RefinedMaps {
  cv::Mat& disparity;        ///< CV_32FC1, left view; in: subpixel winners, out: result
  cv::Mat& right_disparity;  ///< CV_32FC1, winners of the right view; emptied without the check
  cv::Mat& labels;           ///< output: CV_8UC1 of Label
  cv::Mat& confidence;       ///< CV_32FC1; halved where the check fails
};

/// Refines the winners of both views: left-right consistency check, filling, median and bilateral
/// filter. Filled pixels have subpixel disparities of their neighbors. The object has the memory of
/// the filters, so it processes one pair at a time. Parallel by oneTBB.
class DisparityRefiner {
 public:
  /// Memory: the median filter with its border, and the bilateral filter.
  static double bytesPerPixel(const RefinementOptions& options) {
    return 2 * sizeof(float) + (options.bilateral_sigma_px > 0 ? sizeof(float) : 0);
  }

  /// `winners` are the whole-pixel winners of the left view.
  void refine(const cv::Mat& winners, const DisparityRange& range, const RefinementOptions& options,
              const RefinedMaps& maps);

 private:
  void replaceUnmatched(const DisparityRange& range, const RefinementOptions& options,
                        const RefinedMaps& maps);

  cv::Mat filtered_;
  cv::Mat median_padded_;
  cv::Mat bilateral_padded_;
};

}  // namespace cbmv
