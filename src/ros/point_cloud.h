#pragma once

#include <vector>

#include <opencv2/core.hpp>
#include <sensor_msgs/PointCloud2.h>

#include "io/ply.h"

#include "cbmv_stereo/calibration_check.h"

namespace cbmv {

/// What a cloud holds and how it is laid out.
struct CloudOptions {
  double min_depth_m = 0;  ///< nearer points are missing
  double max_depth_m = 0;  ///< points farther away are missing; 0: no limit
  bool with_confidence = false;
  bool compact = false;  ///< rgb at byte 12 in place of 16, and no padding
  bool with_sigma = false;
};

/// What a cloud is made from; all maps have one size.
struct CloudSource {
  cv::Mat disparity;    ///< CV_32FC1, px, so that Z = f T / d; not > 0, or NaN: no point
  cv::Mat color;        ///< CV_8UC3 in the order blue, green, red
  cv::Mat confidence;   ///< CV_32FC1; may be empty without CloudOptions::with_confidence
  cv::Mat depth_sigma;  ///< CV_32FC1, m; empty: NaN everywhere
};

/// Organised cloud in the left camera's optical frame, in metres: fields x, y, z, rgb (float at
/// byte 0, 4, 8, 16; 32 bytes a point), and if wanted confidence (float at byte 20) and sigma
/// (float at byte 24, m: standard deviation of z); compact: rgb at byte 12, then confidence and
/// sigma where they are wanted, without padding (16 to 24 bytes a point). Missing points have NaN
/// in x, y, z and sigma.
sensor_msgs::PointCloud2 toPointCloud(const CloudSource& source, const StereoGeometry& geometry,
                                      const CloudOptions& options, const std_msgs::Header& header);

/// The points of a cloud from toPointCloud that are not NaN.
std::vector<ColoredPoint> fromPointCloud(const sensor_msgs::PointCloud2& message);

}  // namespace cbmv
