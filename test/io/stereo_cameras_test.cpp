#include "io/stereo_cameras.h"

#include <array>
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "io/camera_yaml.h"
#include "support/error_text.h"
#include "support/temporary_folder.h"

namespace cbmv {
namespace {

const std::string kByteOrderMark = "\xEF\xBB\xBF";
const std::string kMiddlebury =
    "cam0=[500 0 200; 0 500 100; 0 0 1]\r\ncam1=[501 0 210; 0 500 101; 0 0 1]\r\n"
    "baseline=120\r\nwidth=400\r\nheight=220\r\nndisp=64\r\n";

/// The lines of camera NUMBER in KITTI's calib_cam_to_cam.txt.
std::string kittiCamera(const std::string& number, double projection_3) {
  return "S_" + number + ": 1.392000e+03 5.120000e+02\nK_" + number +
         ": 9.8e+02 0 6.9e+02 0 9.7e+02 2.4e+02 0 0 1\nD_" + number +
         ": -3.7e-01 2.0e-01 1.3e-03 1.7e-03 -7.2e-02\nS_rect_" + number +
         ": 1.242000e+03 3.750000e+02\nR_rect_" + number + ": 1 0 0 0 1 0 0 0 1\nP_rect_" + number +
         ": 721.5 0 609.5 " + std::to_string(projection_3) + " 0 721.5 172.8 0.2 0 0 1 0.003\n";
}

const std::string kKittiRaw = "calib_time: 09-Jan-2012 13:57:47\n" + kittiCamera("00", 0) +
                              kittiCamera("01", -387.5) + kittiCamera("02", 44.8) +
                              kittiCamera("03", -339.5);

/// EuRoC's file: a camera that looks along the y axis of the body, at `x_m` on its x axis.
std::string euroc(double x_m, const std::string& model = "radial-tangential") {
  return "%YAML:1.0\n# General sensor definitions.\nsensor_type: camera\nT_BS:\n  cols: 4\n"
         "  rows: 4\n  data: [1, 0, 0, " +
         std::to_string(x_m) +
         ",\n         0, 0, 1, 2.0,\n         0, -1, 0, 3.0,\n         0.0, 0.0, 0.0, 1.0]\n"
         "rate_hz: 20\nresolution: [752, 480]\ncamera_model: pinhole\n"
         "intrinsics: [458.6, 457.3, 367.2, 248.4] #fu, fv, cu, cv\ndistortion_model: " +
         model + "\ndistortion_coefficients: [-0.028, 0.0074, 1.9e-4, 1.8e-05]\n";
}

class StereoCamerasTest : public testing::Test {
 protected:
  std::string errorOf(const std::string& left, const std::string& right = "") const {
    return errorText([&] { readStereoCameras(left, right); });
  }

  TemporaryFolder folder_;
};

TEST_F(StereoCamerasTest, ReadsMiddlebury) {
  for (const std::string& begin : {std::string(), kByteOrderMark}) {
    const StereoCameraFile read = readStereoCameras(folder_.write("any name", begin + kMiddlebury));
    const CameraCalibration& right = read.cameras.right;
    EXPECT_TRUE(read.rectified);
    EXPECT_EQ(read.disparities, 64);
    EXPECT_EQ(right.projection,
              (std::array<double, 12>{501, 0, 210, -501 * 0.12, 0, 500, 101, 0, 0, 0, 1, 0}));
    EXPECT_EQ(right.camera_matrix, (std::array<double, 9>{501, 0, 210, 0, 500, 101, 0, 0, 1}));
    EXPECT_EQ(right.rectification, (std::array<double, 9>{1, 0, 0, 0, 1, 0, 0, 0, 1}));
    EXPECT_TRUE(right.distortion.empty());
    EXPECT_EQ(right.width, 400);
    EXPECT_EQ(right.height, 220);
    EXPECT_EQ(read.cameras.left.projection,
              (std::array<double, 12>{500, 0, 200, 0, 0, 500, 100, 0, 0, 0, 1, 0}));
  }
}

TEST_F(StereoCamerasTest, TellsNoDisparitiesWhereThereAreNone) {
  const std::string eth3d = kMiddlebury.substr(0, kMiddlebury.find("ndisp"));
  EXPECT_EQ(readStereoCameras(folder_.write("calib.txt", eth3d)).disparities, 0);
}

TEST_F(StereoCamerasTest, ReadsTheCamerasOfKittiThatAreAskedFor) {
  const std::string file = folder_.write("calib_cam_to_cam.txt", kKittiRaw);
  const StereoCameraFile gray = readStereoCameras(file);
  EXPECT_EQ(gray.cameras.left.projection[3], 0);
  EXPECT_EQ(gray.cameras.right.projection[3], -387.5);
  EXPECT_TRUE(gray.rectified);
  EXPECT_TRUE(mentions(gray.description, {"KITTI", "00", "01"}));
  for (const char* suffix : {":02,03", ":2,3"}) {
    const StereoCameraFile color = readStereoCameras(file + suffix);
    const CameraCalibration& left = color.cameras.left;
    EXPECT_EQ(left.projection[3], 44.8);
    EXPECT_EQ(color.cameras.right.projection[3], -339.5);
    EXPECT_EQ(left.camera_matrix[0], 980);
    EXPECT_EQ(left.distortion, (std::vector<double>{-0.37, 0.2, 1.3e-3, 1.7e-3, -7.2e-2}));
    EXPECT_EQ(left.width, 1242);
    EXPECT_EQ(left.height, 375);
    EXPECT_TRUE(mentions(color.description, {"02", "03"}));
  }
}

TEST_F(StereoCamerasTest, ReadsTheProjectionsOfKitti) {
  const std::string file = folder_.write(
      "000007.txt",
      "P0: 7e2 0 6e2 0 0 7e2 1.7e2 0 0 0 1 0\nP1: 7e2 0 6e2 -350 0 7e2 1.7e2 0 0 0 "
      "1 0\nP2: 7e2 0 6e2 45 0 7e2 1.7e2 0.2 0 0 1 3e-3\nR0_rect: 1 0 0 0 1 0 0 0 1\n");
  const StereoCameraFile read = readStereoCameras(file);
  EXPECT_EQ(read.cameras.right.projection[3], -350);
  EXPECT_EQ(read.cameras.right.camera_matrix[2], 600);
  EXPECT_EQ(read.cameras.right.width, 0);
  EXPECT_TRUE(mentions(errorOf(file + ":02,03"), {file, "P3 is missing"}));
}

TEST_F(StereoCamerasTest, ReadsRos) {
  CameraCalibration camera;
  camera.name = "left";
  camera.width = 320;
  camera.height = 240;
  camera.distortion_model = "plumb_bob";
  camera.distortion = {0.1, 0, 0, 0, 0};
  camera.projection = {300, 0, 160, 0, 0, 300, 120, 0, 0, 0, 1, 0};
  writeCameraYaml(folder_.file("left.yaml"), camera);
  camera.projection[3] = -30;
  writeCameraYaml(folder_.file("right.yaml"), camera);
  const StereoCameraFile read =
      readStereoCameras(folder_.file("left.yaml"), folder_.file("right.yaml"));
  EXPECT_EQ(read.cameras.left.projection[3], 0);
  EXPECT_EQ(read.cameras.right, camera);
  EXPECT_FALSE(read.rectified);
}

TEST_F(StereoCamerasTest, ReadsAndRectifiesEuroc) {
  for (const char* model : {"radial-tangential", "equidistant"}) {
    const StereoCameraFile read =
        readStereoCameras(folder_.write("left.yaml", kByteOrderMark + euroc(0.5, model)),
                          folder_.write("right.yaml", euroc(0.61, model)));
    const auto& left = read.cameras.left;
    const auto& right = read.cameras.right;
    EXPECT_FALSE(read.rectified);
    EXPECT_NEAR(-right.projection[3] / right.projection[0], 0.11, 1e-9) << model;
    EXPECT_EQ(left.projection[3], 0);
    EXPECT_EQ(left.projection[0], right.projection[0]);
    EXPECT_EQ(left.projection[6], right.projection[6]);
    EXPECT_NEAR(left.rectification[0], 1, 1e-9);  // the cameras look in one direction
    EXPECT_EQ(left.camera_matrix,
              (std::array<double, 9>{458.6, 0, 367.2, 0, 457.3, 248.4, 0, 0, 1}));
    EXPECT_EQ(left.distortion_model, model[0] == 'r' ? "plumb_bob" : model);
    EXPECT_EQ(left.width, 752);
    EXPECT_EQ(left.height, 480);
  }
}

TEST_F(StereoCamerasTest, NamesWhatIsMissing) {
  const auto without = [](std::string text, const std::string& part) {
    return text.replace(text.find(part), part.size(), "none");
  };
  const std::string good = folder_.write("good.yaml", euroc(0.6));
  const std::string ros = folder_.write("ros.yaml", "image_width: 3\n");
  for (const auto& [content, key] : std::vector<std::array<std::string, 2>>{
           {kMiddlebury, "cam1"},
           {kMiddlebury, "baseline"},
           {kMiddlebury, "width"},
           {kKittiRaw, "K_00"},
           {kKittiRaw, "P_rect_01"},
           {euroc(0.5), "intrinsics"},
           {euroc(0.5), "resolution"},
           {euroc(0.5), "distortion_coefficients"},
       }) {
    const std::string file = folder_.write("bad", without(content, key));
    EXPECT_TRUE(mentions(errorOf(file, content == euroc(0.5) ? good : ""), {file, key}));
  }
  EXPECT_TRUE(mentions(errorOf(ros, ros), {ros, "image_height"}));
  EXPECT_TRUE(mentions(errorOf(folder_.file("none")), {folder_.file("none"), "no such file"}));
  const std::string text = folder_.write("text.png", "no calibration\n");
  EXPECT_TRUE(mentions(errorOf(text), {text, "cam0", "calib_cam_to_cam.txt", "sensor.yaml"}));
}

TEST_F(StereoCamerasTest, TakesOneFileForBothOrOneForEach) {
  const std::string both = folder_.write("calib.txt", kMiddlebury);
  const std::string left = folder_.write("left.yaml", euroc(0.5));
  const std::string ros = folder_.write("ros.yaml", "image_width: 3\n");
  EXPECT_TRUE(mentions(errorOf(both, left), {both, "both cameras", left}));
  EXPECT_TRUE(mentions(errorOf(left), {left, "only the left camera"}));
  EXPECT_TRUE(mentions(errorOf(left, ros), {ros, "another format", left}));
  EXPECT_TRUE(mentions(errorOf(left, left), {left, "same position"}));
}

TEST_F(StereoCamerasTest, NamesTheModelsOfEurocThatAreKnown) {
  const std::string left = folder_.write("left.yaml", euroc(0.5, "fov"));
  const std::string right = folder_.write("right.yaml", euroc(0.6, "fov"));
  EXPECT_TRUE(mentions(errorOf(left, right), {left, "\"fov\"", "plumb_bob", "equidistant"}));
}

}  // namespace
}  // namespace cbmv
