#pragma once

#include <string>

#include "cbmv_stereo/camera_calibration.h"

namespace cbmv {

/// Content of the calibration files of a rig.
struct StereoCameraFile {
  StereoCameras cameras;
  int disparities = 0;  ///< ndisp of Middlebury's calib.txt; 0: unknown
  /// true: the images of the file are rectified, and only `projection` is meaningful. false: the
  /// file describes raw cameras and how to rectify their images.
  bool rectified = false;
  std::string description;  ///< for logs: the format and, for KITTI, the cameras
};

/// Reads the calibration of a rig. The content, not the name, determines the format:
///
/// - One file for both cameras (`right_path` empty):
///   - Middlebury's or ETH3D's calib.txt (cam0, cam1, baseline in mm, width, height, ndisp).
///     K is the camera matrix, R the identity, D empty.
///   - KITTI's calib_cam_to_cam.txt: K, D, R_rect and P_rect. The size is that of the rectified
///     images (S_rect).
///   - KITTI's calib/NNNNNN.txt and calib.txt of a sequence: P0 … P3. The size is unknown (0).
///   KITTI has four cameras: 00 and 01 are gray, 02 and 03 are color. The default is 00 and 01. To
///   select others, append two numbers to the path: "calib_cam_to_cam.txt:02,03".
/// - One file per camera:
///   - ROS: YAML of camera_calibration (readCameraYaml).
///   - EuRoC: sensor.yaml with T_BS (pose in the body frame), intrinsics, resolution,
///     distortion_model radial-tangential (plumb_bob here) or equidistant. R and P are computed
///     (rectifyRig).
///
/// A byte order mark at the beginning is skipped. Values are not checked: checkCalibration tests
/// whether they form a rectified pair. Throws Error naming the file and the key if a key is missing
/// or malformed, if the format is unknown, or if the right file is missing or superfluous.
StereoCameraFile readStereoCameras(const std::string& left_path,
                                   const std::string& right_path = "");

}  // namespace cbmv
