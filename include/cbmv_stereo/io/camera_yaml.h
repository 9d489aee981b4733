#pragma once

#include <array>
#include <string>
#include <vector>

#include "cbmv_stereo/io/calibration.h"

namespace cbmv {

/// One camera of a rig as sensor_msgs/CameraInfo has it; matrices row by row, in px and m.
struct CameraCalibration {
  std::string name;
  int width = 0;   ///< px
  int height = 0;  ///< px
  std::array<double, 9> camera_matrix{};
  std::string distortion_model;
  std::vector<double> distortion;
  std::array<double, 9> rectification{};
  std::array<double, 12> projection{};  ///< of the rectified image
};

/// Reads the YAML files of camera_calibration and camera_info_manager:
/// http://wiki.ros.org/camera_calibration_parsers. Throws Error naming the file, and the key that
/// is missing or malformed.
CameraCalibration readCameraYaml(const std::string& path);

/// Writes such a file. Throws Error naming the file when it cannot be written.
void writeCameraYaml(const std::string& path, const CameraCalibration& camera);

/// The rectified pair that the projection matrices of both files describe. Throws Error naming the
/// file if the right camera does not lie to the right of the left one, or if the matrices have no
/// common focal length, centre row and size.
StereoCalibration readCameraYamlPair(const std::string& left_path, const std::string& right_path);

}  // namespace cbmv
