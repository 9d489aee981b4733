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

}  // namespace cbmv
