#pragma once

#include <vector>

#include <opencv2/core.hpp>
#include <sensor_msgs/PointCloud2.h>

#include "io/ply.h"

#include "cbmv_stereo/calibration_check.h"

namespace cbmv {

/// Content and layout of a point cloud.
struct CloudOptions {
  double min_depth_m = 0;  ///< nearer points are NaN
  double max_depth_m = 0;  ///< points farther away are NaN; 0: no limit
  bool with_confidence = false;
  bool compact = false;  ///< rgb at byte 12 instead of 16, no padding
  bool with_sigma = false;
};

/// Input of toPointCloud; all maps have the same size.
struct CloudSource {
  cv::Mat disparity;    ///< CV_32FC1, px, Z = f T / d; 0 or less, or NaN: no point
  cv::Mat color;        ///< CV_8UC3, BGR
  cv::Mat confidence;   ///< CV_32FC1; may be empty without CloudOptions::with_confidence
  cv::Mat depth_sigma;  ///< CV_32FC1, m; empty: NaN everywhere
};

/// Builds an organized cloud in the left camera's optical frame, in meters.
/// Default layout, 32 bytes per point: x, y, z, rgb (float at byte 0, 4, 8, 16). Optional:
/// confidence (float at byte 20) and sigma (float at byte 24, m, standard deviation of z).
/// Compact layout, 16 to 24 bytes per point without padding: rgb at byte 12, followed by confidence
/// and sigma if requested.
/// Missing points are NaN in x, y, z and sigma.
sensor_msgs::PointCloud2 toPointCloud(const CloudSource& source, const StereoGeometry& geometry,
                                      const CloudOptions& options, const std_msgs::Header& header);

/// The points of a cloud from toPointCloud that are not NaN.
std::vector<ColoredPoint> fromPointCloud(const sensor_msgs::PointCloud2& message);

}  // namespace cbmv
