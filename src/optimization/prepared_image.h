#pragma once

#include <opencv2/core.hpp>

#include "optimization/cross_based_aggregation.h"
#include "optimization/edge_maps.h"

#include "cbmv_stereo/options.h"

namespace cbmv {

/// Standard deviation of the intensities of an image in gray levels (population standard
/// deviation). It is the unit of the thresholds AggregationOptions::intensity_threshold and
/// SgmOptions::edge_threshold. `gray` is CV_8UC1 and not empty.
float grayDeviation(const cv::Mat& gray);

/// One image of a pair with its data for CBCA and SGM.
struct PreparedImage {
  static constexpr double kBytesPerPixel = 4;  ///< with aggregation: the arms

  cv::Mat gray;         ///< CV_8UC1
  cv::Mat arms;         ///< from computeSupportArms; empty without aggregation
  float deviation = 0;  ///< from grayDeviation
  cv::Mat surface;      ///< surface map (surface_prior.h); empty: unknown

  /// Sets everything except the surface. Memory is reused.
  void prepare(const cv::Mat& image, const AggregationOptions& options);
};

/// Inputs of CBCA for the view with the image `reference`.
SupportArms supportArmsOf(const PreparedImage& reference, const PreparedImage& other,
                          const AggregationOptions& options);

/// Inputs of SGM for this view.
EdgeImages edgeImagesOf(const PreparedImage& reference, const PreparedImage& other,
                        const SgmOptions& options);

}  // namespace cbmv
