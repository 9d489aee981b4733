#include "cbmv_stereo/calibration_check.h"

#include <cmath>
#include <functional>
#include <initializer_list>
#include <limits>
#include <string>
#include <utility>

#include <gtest/gtest.h>
#include <opencv2/calib3d.hpp>

#include "input/camera_properties.h"
#include "support/error_text.h"

namespace cbmv {
namespace {

const InputNames kNames = {"/left/image", "/left/info", "/right/image", "/right/info"};
const cv::Size kSize(320, 240);
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

CameraCalibration camera(double p3) {
  CameraCalibration camera;
  camera.width = kSize.width;
  camera.height = kSize.height;
  camera.camera_matrix = {300, 0, 160, 0, 300, 120, 0, 0, 1};
  camera.rectification = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  camera.projection = {300, 0, 160, p3, 0, 300, 120, 0, 0, 0, 1, 0};
  return camera;
}

StereoCameras goodCameras() { return {camera(0), camera(-30)}; }

CalibrationCheck check(const StereoCameras& cameras,
                       RectifiedBy rectified_by = RectifiedBy::kOthers) {
  return checkCalibration(cameras, kSize, kNames, rectified_by);
}

using Change = std::function<void(StereoCameras&)>;

CalibrationCheck checkWith(const Change& change, RectifiedBy rectified_by = RectifiedBy::kOthers) {
  StereoCameras cameras = goodCameras();
  change(cameras);
  return check(cameras, rectified_by);
}

using Words = std::initializer_list<std::string>;

void expectWarning(Words words, const Change& change) {
  const CalibrationCheck found = checkWith(change);
  EXPECT_TRUE(found.errors.empty());
  ASSERT_EQ(found.warnings.size(), 1U) << *words.begin();
  EXPECT_TRUE(mentions(found.warnings[0], words));
}

void expectError(InputFault fault, Words words, const Change& change,
                 RectifiedBy rectified_by = RectifiedBy::kOthers) {
  const CalibrationCheck found = checkWith(change, rectified_by);
  ASSERT_EQ(found.errors.size(), 1U) << *words.begin();
  EXPECT_EQ(found.errors[0].fault, fault);
  EXPECT_TRUE(mentions(found.errors[0].text, words));
}

std::array<double, 9> turned(double angle) {
  cv::Matx33d rotation;
  cv::Rodrigues(cv::Vec3d(0, angle, 0), rotation);
  std::array<double, 9> values{};
  std::copy(rotation.val, rotation.val + 9, values.begin());
  return values;
}

TEST(CalibrationCheck, FindsNothingInARectifiedPair) {
  const CalibrationCheck found = check(goodCameras());
  EXPECT_TRUE(found.errors.empty());
  EXPECT_TRUE(found.warnings.empty());
  EXPECT_DOUBLE_EQ(found.geometry.baseline_m, 0.1);
  EXPECT_DOUBLE_EQ(found.geometry.focal_length_px, 300);
}

/// KITTI's color cameras and rigs with several cameras: no camera is at the reference.
TEST(CalibrationCheck, TakesTheLeftCamerasPlaceIntoTheBaseline) {
  const CalibrationCheck found = check({camera(6), camera(-24)});
  EXPECT_TRUE(found.warnings.empty());
  EXPECT_DOUBLE_EQ(found.geometry.baseline_m, 0.1);
  EXPECT_DOUBLE_EQ(check({camera(30), camera(0)}).geometry.baseline_m, 0.1);
  EXPECT_DOUBLE_EQ(check({camera(60), camera(30)}).geometry.baseline_m, 0.1);
}

TEST(CalibrationCheck, TakesKittisNumbers) {
  StereoCameras kitti = goodCameras();
  kitti.left.projection = {721.5377, 0,         609.5593, 44.85728, 0, 721.5377,
                           172.854,  0.2163791, 0,        0,        1, 0.002745884};
  kitti.right.projection = {721.5377, 0,        609.5593, -339.5242, 0, 721.5377,
                            172.854,  2.199936, 0,        0,         1, 0.002729905};
  for (CameraCalibration* camera : {&kitti.left, &kitti.right}) {
    camera->width = 1242;
    camera->height = 375;
    camera->distortion = {-0.37, 0.2, 0, 0, -0.06};
  }
  const CalibrationCheck found = checkCalibration(kitti, {1242, 375}, kNames, RectifiedBy::kOthers);
  EXPECT_TRUE(found.errors.empty());
  EXPECT_TRUE(found.warnings.empty());
  EXPECT_NEAR(found.geometry.baseline_m, 0.5327, 1e-4);
}

TEST(CalibrationCheck, WarnsOfCamerasOfDifferentCalibrations) {
  expectWarning({"/left/info and /right/info", "focal length", "330", "300"}, [](auto& cameras) {
    cameras.left.projection[0] = cameras.left.projection[5] = 330;
    cameras.left.camera_matrix[0] = cameras.left.camera_matrix[4] = 330;
  });
  expectWarning({"/left/info and /right/info", "cy", "120", "127"}, [](auto& cameras) {
    cameras.right.projection[6] = cameras.right.camera_matrix[5] = 127;
  });
  for (const std::size_t index : {7U, 11U}) {
    const double value = index == 7 ? 15 : 0.05;
    expectWarning({"/left/info and /right/info", "P[" + std::to_string(index) + "] = "},
                  [&](auto& cameras) { cameras.right.projection[index] = value; });
  }
}

TEST(CalibrationCheck, WarnsOfEntriesThatNoRectifiedCameraHas) {
  for (const std::size_t index : {1U, 4U, 8U, 9U}) {
    expectWarning({"/right/info", "P[" + std::to_string(index) + "] = 2", "expected 0"},
                  [&](auto& cameras) {
                    cameras.right.projection[index] = 2;
                    cameras.right.distortion = {0.1};
                  });
  }
  expectWarning({"/left/info", "P[10] = 2", "expected 1"}, [](auto& cameras) {
    cameras.left.projection[10] = 2;
    cameras.left.distortion = {0.1};
  });
  const CalibrationCheck oblong = checkWith([](auto& cameras) {
    for (CameraCalibration* camera : {&cameras.left, &cameras.right}) {
      camera->projection[5] = camera->camera_matrix[4] = 450;
    }
  });
  ASSERT_EQ(oblong.warnings.size(), 2U);
  EXPECT_TRUE(mentions(oblong.warnings[0], {"/left/info", "fx = 300", "fy = 450"}));
}

TEST(CalibrationCheck, WarnsOfBaselinesInOtherUnits) {
  for (const double p3 : {-30000.0, -0.1}) {  // mm, without the factor f
    expectWarning(
        {"/left/info and /right/info", "baseline", "0.005 to 5 m", "mm", "-fx * baseline"},
        [&](auto& cameras) { cameras.right.projection[3] = p3; });
  }
  for (const double p3 : {-1.5, -1500.0}) {  // 5 mm and 5 m
    EXPECT_TRUE(
        checkWith([&](auto& cameras) { cameras.right.projection[3] = p3; }).warnings.empty());
  }
}

TEST(CalibrationCheck, FindsExchangedAndSingleCameras) {
  expectError(InputFault::kUncalibrated, {"/left/info and /right/info", "P[3] = -30", "exchanged"},
              [](auto& cameras) { std::swap(cameras.left, cameras.right); });
  expectError(InputFault::kUncalibrated, {"P[3] = 0", "calibrated separately"},
              [](auto& cameras) { cameras.right = cameras.left; });
}

TEST(CalibrationCheck, FindsNumbersThatCannotBeComputedWith) {
  expectError(InputFault::kUncalibrated, {"/left/info", "P[2] = nan"},
              [](auto& cameras) { cameras.left.projection[2] = kNan; });
  expectError(InputFault::kUncalibrated, {"/right/info", "P[0] = 0, P[5] = 0"},
              [](auto& cameras) { cameras.right.projection = {}; });
}

TEST(CalibrationCheck, ComparesTheSizes) {
  const auto set_size = [](int width, int height) {
    return [=](StereoCameras& cameras) {
      cameras.right.width = width;
      cameras.right.height = height;
    };
  };
  const InputFault fault = InputFault::kCameraInfoSize;
  expectError(fault, {"/right/info", "240 x 320 px", "320 x 240 px", "exchanged"},
              set_size(240, 320));
  expectError(fault, {"/right/info", "640 x 480 px", "320 x 240 px", "resolution"},
              set_size(640, 480));
  expectWarning({"/right/info", "0 x 0", "320 x 240 px"}, set_size(0, 0));
  EXPECT_TRUE(checkWith(set_size(0, 0), RectifiedBy::kFiles).warnings.empty());
  expectError(fault, {"/left/info", "region of interest (roi) of 319 x 239 px"}, [](auto& cameras) {
    cameras.left.roi = {0, 0, 319, 239};
  });
  expectError(fault, {"/left/info", "160 x 120 px (binning 2 x 2)"},
              [](auto& cameras) { cameras.left.binning_x = cameras.left.binning_y = 2; });
  expectWarning({"/left/info", "principal point at (500, 120)"}, [](auto& cameras) {
    cameras.left.projection[2] = cameras.left.camera_matrix[2] = 500;
  });
}

TEST(CalibrationCheck, FindsRotationsThatAreNone) {
  const Change zero = [](auto& cameras) { cameras.left.rectification = {}; };
  expectError(InputFault::kUncalibrated, {"/left/info", "R that is no rotation (all zero)"}, zero,
              RectifiedBy::kUs);
  expectWarning({"/left/info", "R that is no rotation (all zero)", "not used"}, zero);
  const Change mirrored = [](auto& cameras) { cameras.right.rectification[8] = -1; };
  expectError(InputFault::kUncalibrated,
              {"/right/info", "R that is no rotation (1, 0, 0; 0, 1, 0; 0, 0, -1)"}, mirrored,
              RectifiedBy::kUs);
  EXPECT_TRUE(isRotation(turned(0.3)));
  EXPECT_FALSE(isRotation({1, 0, 0, 0, kNan, 0, 0, 0, 1}));
}

TEST(CalibrationCheck, WarnsWhereImageProcDoesNotRectify) {
  const Change turn = [](auto& cameras) { cameras.left.rectification = turned(0.05); };
  const Change project = [](auto& cameras) { cameras.left.camera_matrix[0] = 310; };
  for (const Change& change : {turn, project}) {
    expectWarning({"/left/info", "D = 0", "image_proc does not rectify"}, change);
    EXPECT_TRUE(checkWith(change, RectifiedBy::kUs).warnings.empty());
    EXPECT_TRUE(checkWith([&](auto& cameras) {
                  change(cameras);
                  cameras.left.distortion = {0.1, 0, 0, 0, 0};
                }).warnings.empty());
  }
}

TEST(CalibrationCheck, FollowsBinningAndRegionOfInterest) {
  StereoCameras cameras = goodCameras();
  for (CameraCalibration* camera : {&cameras.left, &cameras.right}) {
    camera->width = 800;
    camera->height = 600;
    camera->binning_x = camera->binning_y = 2;
    camera->roi = {40, 20, 640, 480};
  }
  cameras.right.roi.x = 50;
  const StereoGeometry geometry = requireUsable(check(cameras));
  EXPECT_DOUBLE_EQ(geometry.focal_length_px, 150);
  EXPECT_DOUBLE_EQ(geometry.baseline_m, 0.1);
  EXPECT_DOUBLE_EQ(geometry.left_cx_px, (160 - 40) / 2.0);
  EXPECT_DOUBLE_EQ(geometry.left_cy_px, (120 - 20) / 2.0);
  EXPECT_DOUBLE_EQ(geometry.disparity_offset_px, 5);
}

TEST(CalibrationCheck, RequireUsableThrowsTheFirstError) {
  StereoCameras cameras = goodCameras();
  cameras.left.projection = {};
  cameras.right.width = 640;
  try {
    requireUsable(check(cameras));
    FAIL() << "nothing was thrown";
  } catch (const InputError& error) {
    EXPECT_EQ(error.fault(), InputFault::kUncalibrated);
    EXPECT_TRUE(mentions(error.what(), {"/left/info"}));
  }
}

}  // namespace
}  // namespace cbmv
