#include "input/rig_rectification.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <opencv2/calib3d.hpp>

#include "cbmv_stereo/error.h"

namespace cbmv {
namespace {

constexpr double kRotationTolerance = 1e-3;  // covers rounded values
const std::string kEquidistant = "equidistant";

void require(bool good, const std::string& what) {
  if (!good) {
    throw Error("Cannot rectify the cameras: " + what + ".");
  }
}

template <typename Numbers>
bool allFinite(const Numbers& numbers) {
  return std::all_of(std::begin(numbers), std::end(numbers),
                     [](double number) { return std::isfinite(number); });
}

void requireCamera(const CameraCalibration& camera, const char* side) {
  const std::string whose = std::string("the ") + side + " camera's ";
  const std::size_t count = camera.distortion.size();
  require(camera.width > 0 && camera.height > 0,
          whose + "width and height are not above 0. Correct them");
  require(
      allFinite(camera.camera_matrix) && camera.camera_matrix[0] > 0 && camera.camera_matrix[4] > 0,
      whose + "camera matrix has focal lengths that are not above 0. Calibrate the camera");
  require(allFinite(camera.distortion),
          whose + "distortion coefficients are not all finite numbers. Calibrate the camera");
  if (camera.distortion_model == kEquidistant) {
    require(count == 4, whose + "distortion model equidistant has " + std::to_string(count) +
                            " coefficients, expected 4. Correct them");
  } else {
    require(
        camera.distortion_model == "plumb_bob" || camera.distortion_model == "rational_polynomial",
        whose + "distortion model is \"" + camera.distortion_model +
            "\", expected plumb_bob, rational_polynomial or equidistant. Correct distortion_model");
    require(count == 0 || count == 4 || count == 5 || count == 8,
            whose + "distortion coefficients are " + std::to_string(count) +
                ", expected 4, 5 or 8. Correct them");
  }
}

void requireTransform(const RigTransform& transform) {
  const cv::Matx33d& rotation = transform.rotation;
  require(
      cv::norm(rotation * rotation.t(), cv::Matx33d::eye(), cv::NORM_INF) < kRotationTolerance &&
          cv::determinant(rotation) > 0,
      "the transform from the left to the right camera has no valid rotation. Calibrate the "
      "cameras");
  require(allFinite(transform.translation.val) && cv::norm(transform.translation) > 0,
          "both cameras are at the same position, expected a baseline. Calibrate the cameras");
}

cv::Matx33d matrixOf(const CameraCalibration& camera) {
  return cv::Matx33d(camera.camera_matrix.data());
}

}  // namespace

void rectifyRig(StereoCameras& cameras, const RigTransform& right_from_left) {
  CameraCalibration& left = cameras.left;
  CameraCalibration& right = cameras.right;
  requireCamera(left, "left");
  requireCamera(right, "right");
  require((left.distortion_model == kEquidistant) == (right.distortion_model == kEquidistant),
          "only one camera has the distortion model equidistant, expected both or none. Calibrate "
          "both with one model");
  require(left.width == right.width && left.height == right.height,
          "their images have different sizes, expected equal sizes. Use images of one resolution");
  requireTransform(right_from_left);
  const cv::Size size(left.width, left.height);
  cv::Matx33d rotations[2];
  cv::Matx34d projections[2];
  cv::Matx44d depth_of_disparity;
  try {
    if (left.distortion_model == kEquidistant) {
      cv::fisheye::stereoRectify(matrixOf(left), left.distortion, matrixOf(right), right.distortion,
                                 size, right_from_left.rotation, right_from_left.translation,
                                 rotations[0], rotations[1], projections[0], projections[1],
                                 depth_of_disparity, cv::CALIB_ZERO_DISPARITY);
    } else {
      cv::stereoRectify(matrixOf(left), left.distortion, matrixOf(right), right.distortion, size,
                        right_from_left.rotation, right_from_left.translation, rotations[0],
                        rotations[1], projections[0], projections[1], depth_of_disparity,
                        cv::CALIB_ZERO_DISPARITY, 0);
    }
  } catch (const cv::Exception& error) {
    require(false, std::string("OpenCV finds no rectification (") + error.what() + ")");
  }
  const auto take = [&](int side, CameraCalibration& camera) {
    std::copy_n(rotations[side].val, 9, camera.rectification.begin());
    std::copy_n(projections[side].val, 12, camera.projection.begin());
  };
  take(0, left);
  take(1, right);
}

}  // namespace cbmv
