#pragma once

#include <array>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "cbmv_stereo/export.h"

namespace cbmv {

/// One calibrated camera. Fields and conventions are those of sensor_msgs/CameraInfo. Matrices are
/// stored row by row.
struct CBMV_API CameraCalibration {
  std::string name;
  int width = 0;                          ///< px, whole sensor without binning; 0: unknown
  int height = 0;                         ///< px, whole sensor without binning; 0: unknown
  std::array<double, 9> camera_matrix{};  ///< K, px, of the raw image
  std::string distortion_model;           ///< plumb_bob, rational_polynomial or equidistant
  std::vector<double> distortion;         ///< D; empty or all zero: no distortion
  std::array<double, 9> rectification{};  ///< R, a rotation
  /// P, of the rectified image: px; the last column is in px m (−fx · Tx).
  std::array<double, 12> projection{};
  int binning_x = 1;  ///< raw pixels per pixel; 1: no binning
  int binning_y = 1;  ///< raw pixels per pixel; 1: no binning
  cv::Rect roi;       ///< part of the sensor in the image, sensor px; empty: all

  bool operator==(const CameraCalibration& other) const;
  bool operator!=(const CameraCalibration& other) const { return !(*this == other); }
};

/// The calibrations of both cameras of a rig.
struct StereoCameras {
  CameraCalibration left;
  CameraCalibration right;

  bool operator==(const StereoCameras& other) const {
    return left == other.left && right == other.right;
  }
  bool operator!=(const StereoCameras& other) const { return !(*this == other); }
};

}  // namespace cbmv
