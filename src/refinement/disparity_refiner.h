#pragma once

#include <opencv2/core.hpp>

#include "cbmv_stereo/disparity_range.h"
#include "cbmv_stereo/options.h"

namespace cbmv {

/// The maps that are refined, all of one size.
struct RefinedMaps {
  cv::Mat& disparity;  ///< CV_32FC1, left view; sub-pixel winners become the result
  cv::Mat&
      right_disparity;  ///< CV_32FC1, winners of the right view; becomes empty without the check
  cv::Mat& labels;      ///< becomes CV_8UC1 of Label
  cv::Mat& confidence;  ///< CV_32FC1; becomes half where the check failed
};

/// Refinement of the winners of both views: left-right check, filling, median and bilateral filter.
/// Filled pixels take sub-pixel disparities from their neighbours. Holds the memory
/// of the filters, so one object serves one pair at a time. Parallel by oneTBB.
class DisparityRefiner {
 public:
  /// `winners` are the left view's, in whole pixels.
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
