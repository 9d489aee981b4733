#pragma once

#include <string>

#include "io/calibration.h"

#include "cbmv_stereo/camera_calibration.h"

namespace cbmv {

/// Reads the YAML files of camera_calibration and camera_info_manager:
/// http://wiki.ros.org/camera_calibration_parsers. binning_x, binning_y (at least 1) and roi
/// (x_offset, y_offset, width, height) are read where they are there, as CameraInfo has them.
/// Throws Error naming the file, and the key that is missing or malformed.
CameraCalibration readCameraYaml(const std::string& path);

/// Writes such a file. Throws Error naming the file when it cannot be written.
void writeCameraYaml(const std::string& path, const CameraCalibration& camera);

/// The rectified pair that the projection matrices of both files describe. Throws Error naming the
/// file if the right camera does not lie to the right of the left one, or if the matrices have no
/// common focal length, centre row and size.
StereoCalibration readCameraYamlPair(const std::string& left_path, const std::string& right_path);

}  // namespace cbmv
