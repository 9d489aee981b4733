#pragma once

#include <string>

#include <opencv2/core.hpp>
#include <sensor_msgs/CameraInfo.h>

#include "ros/input_messages.h"

namespace cbmv {

/// The rectified stereo camera, from the projection matrices, in pixels of the images as they are
/// sent (after binning and region of interest).
struct StereoGeometry {
  double focal_length_px = 0;  ///< of the right camera, horizontal: f in Z = f T / d
  double baseline_m = 0;       ///< T > 0: the right camera lies to the right of the left one
  /// cx_left − cx_right, 0 unless the rig is verged: a point at infinity is matched at this
  /// disparity, so it is taken off (once) of what is published.
  double disparity_offset_px = 0;
  double left_fx_px = 0;
  double left_fy_px = 0;
  double left_cx_px = 0;
  double left_cy_px = 0;
};

/// From the infos of both cameras and the size of their images; `topics` names the infos to people.
/// Throws InputError if a camera is not calibrated, if left and right are swapped, or if an info
/// describes images of another size.
StereoGeometry toGeometry(const sensor_msgs::CameraInfo& left_info,
                          const sensor_msgs::CameraInfo& right_info, cv::Size image_size,
                          const StereoTopics& topics);

/// Of images in the left camera's rectified frame, `size` large: K is the projection matrix's, no
/// distortion, rotation, binning nor region of interest are left.
sensor_msgs::CameraInfo toRectifiedInfo(const StereoGeometry& geometry, cv::Size size,
                                        const std_msgs::Header& header);

}  // namespace cbmv
