#pragma once

#include <opencv2/core.hpp>

namespace cbmv {

/// The two images of a pair as semi-global matching sees them: CV_8UC1, same size, and the
/// intensity step in gray levels from which on a step counts as an edge (tau_so times the image's
/// standard deviation).
struct EdgeImages {
  cv::Mat reference;
  cv::Mat other;
  float reference_threshold_grey = 0;
  float other_threshold_grey = 0;
};

/// Edges of an image, CV_8UC1: non-zero at (y, x) where there is one between (y, x) and
/// its left neighbour (`horizontal`) or its upper neighbour (`vertical`). One row and one column
/// larger than the image, zero where a neighbour is missing.
struct EdgeMaps {
  cv::Mat horizontal;
  cv::Mat vertical;
};

/// Finds the edges of `grey` (CV_8UC1). The memory of `edges` is reused. Parallel over rows by
/// oneTBB.
void findEdges(const cv::Mat& grey, float threshold_grey, EdgeMaps& edges);

}  // namespace cbmv
