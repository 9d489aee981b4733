#pragma once

#include <optional>
#include <utility>
#include <vector>

#include <opencv2/core.hpp>

namespace cbmv {

/// A chessboard described by its inner corners.
struct Chessboard {
  cv::Size corners{9, 6};  ///< columns and rows
  double square_m = 0.025;

  /// Positions of the corners on the board, m, row by row; z = 0.
  std::vector<cv::Point3f> points() const;
};

/// Corners of a board in an image, px, in the order of Chessboard::points().
using BoardCorners = std::vector<cv::Point2f>;

/// Finds the corners in a CV_8UC1 image with subpixel accuracy. Returns nothing if the whole board
/// is not visible.
std::optional<BoardCorners> findBoard(const cv::Mat& image, const Chessboard& board);

/// The same board in both images of a pair.
struct BoardView {
  BoardCorners left, right;
};

/// A camera with the values of sensor_msgs/CameraInfo.
struct CalibratedCamera {
  cv::Matx33d matrix;              ///< K, px
  std::vector<double> distortion;  ///< plumb_bob: k1, k2, p1, p2, k3
  cv::Matx33d rotation;            ///< R: from the camera to the rectified camera
  cv::Matx34d projection;  ///< P of the rectified camera, px; P(0, 3) = -fx * baseline, px m
};

struct CalibratedRig {
  cv::Size image_size;
  CalibratedCamera left, right;
  double reprojection_error_px = 0;  ///< RMS over all corners of both cameras
  double epipolar_error_px = 0;      ///< RMS row difference of rectified corners

  double baselineM() const { return -right.projection(0, 3) / right.projection(0, 0); }
};

/// Calibrates and rectifies a rig with two cameras side by side (OpenCV's calibrateCamera,
/// stereoCalibrate, stereoRectify). Both rectified cameras have the same principal point; the
/// images have no invalid border pixels. Throws Error for fewer than three views or if a view does
/// not have all corners.
CalibratedRig calibrateRig(const std::vector<BoardView>& views, const Chessboard& board,
                           cv::Size image_size);

}  // namespace cbmv
