#pragma once

#include <string>

#include "cbmv_stereo/camera_calibration.h"

namespace cbmv {

/// What the calibration files of a rig tell.
struct StereoCameraFile {
  StereoCameras cameras;
  int disparities = 0;  ///< ndisp of Middlebury's calib.txt; 0: not told
  /// The file comes with images that are rectified: only `projection` counts. Otherwise it
  /// describes raw cameras and how their images are rectified.
  bool rectified = false;
  std::string description;  ///< for logs: the format and, of KITTI, which cameras
};

/// Reads the calibration of a rig. The content tells the format, not the name:
///
/// - One file for both cameras (`right_path` empty):
///   - Middlebury's or ETH3D's calib.txt (cam0, cam1, baseline in mm, width, height, ndisp).
///     K is the camera matrix, R the identity, D empty.
///   - KITTI's calib_cam_to_cam.txt: K, D, R_rect and P_rect; the size is that of the rectified
///     images (S_rect).
///   - KITTI's calib/NNNNNN.txt and calib.txt of a sequence: P0 … P3. No size is told (0).
///   KITTI has four cameras: 00 and 01 are gray, 02 and 03 color. The first pair is taken unless
///   the path ends with two numbers: "calib_cam_to_cam.txt:02,03".
/// - One file each:
///   - ROS: YAML of camera_calibration (readCameraYaml).
///   - EuRoC: sensor.yaml with T_BS (in the body frame), intrinsics, resolution, distortion_model
///     radial-tangential (plumb_bob here) or equidistant. R and P are computed (rectifyRig).
///
/// A byte order mark at the beginning is skipped. Values are taken as they are: whether they make a
/// rectified pair is for others to check. Throws Error naming the file, and the key that is missing
/// or malformed; when the format is not known; and when the right file is missing or too much.
StereoCameraFile readStereoCameras(const std::string& left_path,
                                   const std::string& right_path = "");

}  // namespace cbmv
