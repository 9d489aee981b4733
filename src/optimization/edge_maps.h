#pragma once

#include <opencv2/core.hpp>

namespace cbmv {

/// The images of a pair for SGM: CV_8UC1, of the same size. An intensity difference of at least the
/// threshold, in gray levels, is an edge (tau_so times the standard deviation of the intensities).
struct EdgeImages {
  cv::Mat reference;
  cv::Mat other;
  float reference_threshold_gray = 0;
  float other_threshold_gray = 0;
};

/// Edges of an image, CV_8UC1. A pixel (y, x) is non-zero if there is an edge between it and its
/// left neighbor (`horizontal`) or its upper neighbor (`vertical`). The maps have one row and one
/// column more than the image. Pixels without this neighbor are zero.
struct EdgeMaps {
  static constexpr double kBytesPerPixel = 1 + 1;

  cv::Mat horizontal;
  cv::Mat vertical;
};

/// The lowest whole step that reaches the threshold; 256, which no step reaches, above all of them.
int lowestStep(float threshold_gray);

/// Finds the edges of `gray` (CV_8UC1). Reuses the memory of `edges`. Parallel over rows by oneTBB.
void findEdges(const cv::Mat& gray, float threshold_gray, EdgeMaps& edges);

}  // namespace cbmv
