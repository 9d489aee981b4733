#include "tools/rig_calibration.h"

#include <cmath>
#include <string>

#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "cbmv_stereo/error.h"

namespace cbmv {
namespace {

constexpr std::size_t kFewestViews = 3;
constexpr int kCornerWindowPx = 5;  // half size of the window for subpixel refinement
const cv::TermCriteria kUntilStill(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 100, 1e-6);

void checkViews(const std::vector<BoardView>& views, const Chessboard& board) {
  if (views.size() < kFewestViews) {
    throw Error("the whole board is visible in " + std::to_string(views.size()) +
                " pairs, expected at least " + std::to_string(kFewestViews) +
                ". Take more pairs that show the whole board");
  }
  const auto corners = static_cast<std::size_t>(board.corners.area());
  for (const BoardView& view : views) {
    if (view.left.size() != corners || view.right.size() != corners) {
      throw Error("a view has " + std::to_string(view.left.size()) + " and " +
                  std::to_string(view.right.size()) + " corners, expected " +
                  std::to_string(corners) + " in both images. Leave out this pair");
    }
  }
}

/// Rectified positions of the corners, px.
std::vector<cv::Point2f> rectified(const BoardCorners& corners, const CalibratedCamera& camera) {
  std::vector<cv::Point2f> points;
  cv::undistortPoints(corners, points, camera.matrix, camera.distortion, camera.rotation,
                      camera.projection);
  return points;
}

double epipolarError(const std::vector<BoardView>& views, const CalibratedRig& rig) {
  double sum = 0;
  std::size_t count = 0;
  for (const BoardView& view : views) {
    const auto left = rectified(view.left, rig.left);
    const auto right = rectified(view.right, rig.right);
    for (std::size_t i = 0; i < left.size(); ++i, ++count) {
      sum += std::pow(left[i].y - right[i].y, 2);
    }
  }
  return std::sqrt(sum / static_cast<double>(count));
}

}  // namespace

std::vector<cv::Point3f> Chessboard::points() const {
  std::vector<cv::Point3f> points;
  for (int row = 0; row < corners.height; ++row) {
    for (int column = 0; column < corners.width; ++column) {
      points.emplace_back(static_cast<float>(column * square_m), static_cast<float>(row * square_m),
                          0.0F);
    }
  }
  return points;
}

std::optional<BoardCorners> findBoard(const cv::Mat& image, const Chessboard& board) {
  BoardCorners corners;
  if (!cv::findChessboardCorners(image, board.corners, corners)) {
    return std::nullopt;
  }
  cv::cornerSubPix(image, corners, {kCornerWindowPx, kCornerWindowPx}, {-1, -1}, kUntilStill);
  return corners;
}

CalibratedRig calibrateRig(const std::vector<BoardView>& views, const Chessboard& board,
                           cv::Size image_size) {
  checkViews(views, board);
  const std::vector<std::vector<cv::Point3f>> points(views.size(), board.points());
  std::vector<BoardCorners> left, right;
  for (const BoardView& view : views) {
    left.push_back(view.left);
    right.push_back(view.right);
  }
  CalibratedRig rig;
  rig.image_size = image_size;
  std::vector<cv::Mat> rotations, translations;
  for (auto* camera : {&rig.left, &rig.right}) {
    camera->matrix = cv::Matx33d::eye();
    cv::calibrateCamera(points, camera == &rig.left ? left : right, image_size, camera->matrix,
                        camera->distortion, rotations, translations);
  }
  cv::Mat rotation, translation, essential, fundamental, depth_of_disparity;
  rig.reprojection_error_px =
      cv::stereoCalibrate(points, left, right, rig.left.matrix, rig.left.distortion,
                          rig.right.matrix, rig.right.distortion, image_size, rotation, translation,
                          essential, fundamental, cv::CALIB_USE_INTRINSIC_GUESS, kUntilStill);
  cv::stereoRectify(rig.left.matrix, rig.left.distortion, rig.right.matrix, rig.right.distortion,
                    image_size, rotation, translation, rig.left.rotation, rig.right.rotation,
                    rig.left.projection, rig.right.projection, depth_of_disparity,
                    cv::CALIB_ZERO_DISPARITY, 0);
  rig.epipolar_error_px = epipolarError(views, rig);
  return rig;
}

}  // namespace cbmv
