#pragma once

#include <array>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "cbmv_stereo/export.h"

namespace cbmv {

/// One calibrated camera, with the fields and conventions of sensor_msgs/CameraInfo. Matrices are
/// stored row by row.
struct CBMV_API CameraCalibration {
  std::string name;
  int width = 0;                          ///< px, of the whole sensor without binning; 0: unknown
  int height = 0;                         ///< px, of the whole sensor without binning; 0: unknown
  std::array<double, 9> camera_matrix{};  ///< K, px, of the raw image
  std::string distortion_model;           ///< plumb_bob, rational_polynomial or equidistant
  std::vector<double> distortion;         ///< D, empty or all zero: none
  std::array<double, 9> rectification{};  ///< R, a rotation
  /// P, of the rectified image: px, and in the last column px m (−fx · Tx).
  std::array<double, 12> projection{};
  int binning_x = 1;  ///< raw pixels per pixel; 1: none
  int binning_y = 1;  ///< raw pixels per pixel; 1: none
  cv::Rect roi;       ///< part of the sensor that the image shows, px of the sensor; empty: all

  bool operator==(const CameraCalibration& other) const;
  bool operator!=(const CameraCalibration& other) const { return !(*this == other); }
};

/// Both cameras of a rig.
struct StereoCameras {
  CameraCalibration left;
  CameraCalibration right;

  bool operator==(const StereoCameras& other) const {
    return left == other.left && right == other.right;
  }
  bool operator!=(const StereoCameras& other) const { return !(*this == other); }
};

}  // namespace cbmv
