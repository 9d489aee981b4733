#include "input/rig_rectification.h"

#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/calib3d.hpp>

#include "support/error_text.h"

namespace cbmv {
namespace {

CameraCalibration makeCamera(const std::string& model, std::vector<double> distortion, double f) {
  CameraCalibration camera;
  camera.width = 640;
  camera.height = 480;
  camera.camera_matrix = {f, 0, 310, 0, f + 2, 245, 0, 0, 1};
  camera.distortion_model = model;
  camera.distortion = std::move(distortion);
  return camera;
}

RigTransform makeTransform() {
  RigTransform transform;
  cv::Rodrigues(cv::Vec3d(0.02, -0.03, 0.01), transform.rotation);
  transform.translation = {-0.12, 0.003, 0.002};
  return transform;
}

/// Rectified image points of a camera at `pose`.
std::vector<cv::Point2d> rectifiedPoints(const std::vector<cv::Point3d>& points,
                                         const CameraCalibration& camera,
                                         const RigTransform& pose) {
  const cv::Matx33d matrix(camera.camera_matrix.data());
  const cv::Matx33d rotation(camera.rectification.data());
  const cv::Matx34d projection(camera.projection.data());
  cv::Vec3d turn;
  cv::Rodrigues(pose.rotation, turn);
  std::vector<cv::Point2d> seen, rectified;
  if (camera.distortion_model == "equidistant") {
    cv::fisheye::projectPoints(points, seen, turn, pose.translation, matrix, camera.distortion);
    cv::fisheye::undistortPoints(seen, rectified, matrix, camera.distortion, rotation, projection);
  } else {
    cv::projectPoints(points, turn, pose.translation, matrix, camera.distortion, seen);
    cv::undistortPoints(seen, rectified, matrix, camera.distortion, rotation, projection);
  }
  return rectified;
}

/// Expects equal rows, and disparities of focal length times baseline over depth.
void expectRectifies(StereoCameras cameras) {
  const RigTransform transform = makeTransform();
  rectifyRig(cameras, transform);
  std::vector<cv::Point3d> points;
  for (const double z : {1.0, 3.0}) {
    for (const double x : {-0.3, 0.0, 0.2}) {
      points.insert(points.end(), {{x * z, -0.2 * z, z}, {x * z, 0.25 * z, z}});
    }
  }
  const auto left = rectifiedPoints(points, cameras.left, {});
  const auto right = rectifiedPoints(points, cameras.right, transform);
  const auto& projection = cameras.left.projection;
  const double fb = -cameras.right.projection[3];
  EXPECT_NEAR(fb / projection[0], cv::norm(transform.translation), 1e-9);
  const cv::Matx33d rotation(cameras.left.rectification.data());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double depth = (rotation * points[i]).z;
    EXPECT_NEAR(left[i].y, right[i].y, 1e-2);
    EXPECT_NEAR(left[i].x - right[i].x, fb / depth, 2e-2);
  }
}

TEST(RigRectification, AlignsTheRows) {
  expectRectifies({makeCamera("plumb_bob", {}, 400), makeCamera("plumb_bob", {}, 405)});
  expectRectifies({makeCamera("plumb_bob", {-0.28, 0.07, 1e-4, 2e-5, 0}, 400),
                   makeCamera("plumb_bob", {-0.27, 0.06, -1e-4, 1e-5, 0}, 405)});
  expectRectifies({makeCamera("rational_polynomial", {0.2, 0.1, 0, 0, 0.01, 0.5, 0.2, 0.02}, 400),
                   makeCamera("plumb_bob", {-0.1, 0.02, 0, 0}, 405)});
}

TEST(RigRectification, AlignsTheRowsOfFisheyes) {
  expectRectifies({makeCamera("equidistant", {0.01, -0.02, 0.005, -0.001}, 300),
                   makeCamera("equidistant", {0.012, -0.018, 0.004, -0.001}, 302)});
}

TEST(RigRectification, SaysWhatIsWrong) {
  const StereoCameras good = {makeCamera("plumb_bob", {}, 400), makeCamera("plumb_bob", {}, 400)};
  const auto expectError = [](StereoCameras cameras, const RigTransform& transform,
                              const std::string& part) {
    EXPECT_TRUE(mentions(errorText([&] { rectifyRig(cameras, transform); }), {part}));
  };
  StereoCameras bad = good;
  bad.right.width = 320;
  expectError(bad, makeTransform(), "different sizes");
  bad = good;
  bad.left.height = 0;
  expectError(bad, makeTransform(), "left camera's width and height");
  bad = good;
  bad.right.distortion_model = "fov";
  expectError(bad, makeTransform(), "right camera's distortion model is \"fov\"");
  bad = good;
  bad.right.distortion = {0.1};
  expectError(bad, makeTransform(), "right camera's distortion coefficients are 1, expected 4");
  bad = good;
  bad.right = makeCamera("equidistant", {0, 0, 0, 0}, 400);
  expectError(bad, makeTransform(), "only one camera has the distortion model equidistant");
  bad = good;
  bad.left.camera_matrix[0] = std::numeric_limits<double>::quiet_NaN();
  expectError(bad, makeTransform(), "left camera's camera matrix");
  RigTransform transform = makeTransform();
  transform.rotation(1, 1) = 0;
  expectError(good, transform, "no valid rotation");
  transform = makeTransform();
  transform.translation = {0, 0, 0};
  expectError(good, transform, "same position");
}

}  // namespace
}  // namespace cbmv
