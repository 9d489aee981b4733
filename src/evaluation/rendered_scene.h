#pragma once

#include <opencv2/core.hpp>

namespace cbmv {

/// A synthetic rectified pair with exact ground truth.
struct RenderedScene {
  cv::Mat left;     ///< CV_8UC1
  cv::Mat right;    ///< CV_8UC1
  cv::Mat truth;    ///< CV_32FC1: exact disparity of the left image, px, known everywhere
  cv::Mat visible;  ///< CV_8UC1: 255 where both cameras see the point, else 0
};

struct RenderOptions {
  double noise_sigma = 1.0;   ///< gray levels, independent in both images
  double right_gain = 0.97;   ///< brightness of the right image = gain · left + offset
  double right_offset = 3.0;  ///< gray levels
  double vertical_offset =
      0.0;  ///< px: row in the right image minus row in the left image, at the image center
  double vertical_slope_x = 0.0;  ///< px per column of the right image
  double vertical_slope_y = 0.0;  ///< px per row of the left image
  double vertical_twist = 0.0;    ///< px per (column of the right image · row of the left image)
  double vertical_curvature_x = 0.0;  ///< px per squared column from the center
  double vertical_curvature_y = 0.0;  ///< px per squared row from the center
};

/// Renders a scene of textured planes: a slanted background (about 2 to 5 px of disparity) and six
/// rectangles and discs in front of it (about 6 to 25 px), two of them slanted. Both images sample
/// the same continuous texture, so `truth` is exact. The same arguments give the same scene. With a
/// vertical offset, `truth` and `visible` are those of the pair without the offset.
RenderedScene renderScene(int width, int height, int seed, const RenderOptions& options = {});

}  // namespace cbmv
