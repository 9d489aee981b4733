#pragma once

#include <string>

#include "io/calibration.h"

#include "cbmv_stereo/camera_calibration.h"

namespace cbmv {

/// Reads the YAML files of camera_calibration and camera_info_manager:
/// http://wiki.ros.org/camera_calibration_parsers. Optional keys: binning_x, binning_y (at least 1)
/// and roi (x_offset, y_offset, width, height), as in CameraInfo. Throws Error naming the file and
/// the key that is missing or malformed.
CameraCalibration readCameraYaml(const std::string& path);

/// Writes a YAML file of this format. Throws Error naming the file if it cannot be written.
void writeCameraYaml(const std::string& path, const CameraCalibration& camera);

/// Reads the rectified pair from the projection matrices of both files. Throws Error naming the
/// file if the right camera is not to the right of the left camera, or if focal length, cy or size
/// differ.
StereoCalibration readCameraYamlPair(const std::string& left_path, const std::string& right_path);

}  // namespace cbmv
