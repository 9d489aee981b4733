#pragma once

#include <string>

#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/Image.h>
#include <sensor_msgs/PointCloud2.h>
#include <stereo_msgs/DisparityImage.h>

namespace cbmv {

/// Write a message as a file; the extension of `path` selects the format. All functions throw Error
/// with the file when it cannot be written.

/// .pfm: px, +infinity = none, as in Middlebury. .png: KITTI, 16 bits, 256 · px, 0 = none.
void writeMessageFile(const std::string& path, const stereo_msgs::DisparityImage& message);
/// 32FC1 as .pfm; 16UC1, mono8 and rgb8 as .png.
void writeMessageFile(const std::string& path, const sensor_msgs::Image& message);
/// The valid points as binary .ply.
void writeMessageFile(const std::string& path, const sensor_msgs::PointCloud2& message);
/// YAML as written by camera_calibration_parsers.
void writeMessageFile(const std::string& path, const sensor_msgs::CameraInfo& message);

}  // namespace cbmv
