#pragma once

#include <opencv2/core.hpp>

#include "optimization/cross_based_aggregation.h"
#include "optimization/edge_maps.h"

#include "cbmv_stereo/options.h"

namespace cbmv {

/// One image of a pair with what aggregation and semi-global matching need of it.
struct PreparedImage {
  cv::Mat gray;         ///< CV_8UC1
  cv::Mat arms;         ///< computeSupportArms; empty if there is no aggregation
  float deviation = 0;  ///< greyDeviation
  cv::Mat surface;      ///< map of surface_prior.h; empty: unknown

  /// Sets all but the surface; memory is reused.
  void prepare(const cv::Mat& image, const AggregationOptions& options);
};

/// What aggregation takes of the view whose image is `reference`.
SupportArms supportArmsOf(const PreparedImage& reference, const PreparedImage& other,
                          const AggregationOptions& options);

/// What semi-global matching takes of it.
EdgeImages edgeImagesOf(const PreparedImage& reference, const PreparedImage& other,
                        const SgmOptions& options);

}  // namespace cbmv
