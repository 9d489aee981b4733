#pragma once

#include <string>

#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/Image.h>
#include <sensor_msgs/PointCloud2.h>
#include <stereo_msgs/DisparityImage.h>

namespace cbmv {

/// Messages as files; the extension of `path` says how. All throw Error that names the file when it
/// cannot be written.

/// .pfm: px, +infinity where there is none, as Middlebury has it; .png: KITTI's, 256 times px in 16
/// bits, 0 where there is none.
void writeMessageFile(const std::string& path, const stereo_msgs::DisparityImage& message);
/// 32FC1 as .pfm; 16UC1, mono8 and rgb8 as .png.
void writeMessageFile(const std::string& path, const sensor_msgs::Image& message);
/// The points that there are, as binary .ply.
void writeMessageFile(const std::string& path, const sensor_msgs::PointCloud2& message);
/// The .yaml of camera_calibration_parsers.
void writeMessageFile(const std::string& path, const sensor_msgs::CameraInfo& message);

}  // namespace cbmv
