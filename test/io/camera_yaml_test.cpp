#include "io/camera_yaml.h"

#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include "support/error_text.h"
#include "support/temporary_folder.h"

namespace cbmv {
namespace {

/// As written by camera_calibration.
const char* const kLeft =
    "image_width: 640\nimage_height: 480\ncamera_name: narrow_stereo/left\n"
    "camera_matrix:\n  rows: 3\n  cols: 3\n"
    "  data: [  520.5,    0. ,  310.25,\n            0. ,  521. ,  245.5 ,\n"
    "            0. ,    0. ,    1. ]\n"
    "distortion_model: plumb_bob\n"
    "distortion_coefficients:\n  rows: 1\n  cols: 5\n  data: [-0.25, 0.125, 1e-3, -2e-3, 0.0]\n"
    "rectification_matrix:\n  rows: 3\n  cols: 3\n  data: [1., 0., 0., 0., 1., 0., 0., 0., 1.]\n"
    "projection_matrix:\n  rows: 3\n  cols: 4\n"
    "  data: [500., 0., 320.5, 0., 0., 500., 240.25, 0., 0., 0., 1., 0.]\n";

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  return text.replace(text.find(from), from.size(), to);
}

const std::string kRight = replaced(kLeft, "500., 0., 320.5, 0.,", "500., 0., 325.5, -60.,");

TEST(CameraYaml, ReadsWhatCameraCalibrationWrites) {
  const TemporaryFolder folder;
  const CameraCalibration camera = readCameraYaml(folder.write("left.yaml", kLeft));
  EXPECT_EQ(camera.name, "narrow_stereo/left");
  EXPECT_EQ(camera.width, 640);
  EXPECT_EQ(camera.height, 480);
  EXPECT_EQ(camera.camera_matrix[0], 520.5);
  EXPECT_EQ(camera.camera_matrix[5], 245.5);
  EXPECT_EQ(camera.distortion_model, "plumb_bob");
  EXPECT_EQ(camera.distortion, (std::vector<double>{-0.25, 0.125, 1e-3, -2e-3, 0}));
  EXPECT_EQ(camera.rectification[8], 1);
  EXPECT_EQ(camera.projection[6], 240.25);
}

TEST(CameraYaml, ComesBackAsWritten) {
  const TemporaryFolder folder;
  CameraCalibration camera = readCameraYaml(folder.write("left.yaml", kLeft));
  for (const char* name : {"left_camera", "", "a: b", "/ns/left"}) {
    camera.name = name;
    camera.projection[2] = 1.0 / 3;
    writeCameraYaml(folder.file("again.yaml"), camera);
    const CameraCalibration again = readCameraYaml(folder.file("again.yaml"));
    EXPECT_EQ(again.name, name);
    EXPECT_EQ(again.height, camera.height);
    EXPECT_EQ(again.camera_matrix, camera.camera_matrix);
    EXPECT_EQ(again.distortion_model, camera.distortion_model);
    EXPECT_EQ(again.distortion, camera.distortion);
    EXPECT_EQ(again.rectification, camera.rectification);
    EXPECT_EQ(again.projection, camera.projection);
  }
}

TEST(CameraYaml, PairHasBaselineAndCentres) {
  const TemporaryFolder folder;
  const StereoCalibration pair =
      readCameraYamlPair(folder.write("left.yaml", kLeft), folder.write("right.yaml", kRight));
  EXPECT_EQ(pair.focal_length_px, 500);
  EXPECT_DOUBLE_EQ(pair.baseline_m, 0.12);
  EXPECT_EQ(pair.doffs(), 5);
  EXPECT_EQ(pair.cy, 240.25);
  EXPECT_EQ(pair.width, 640);
  EXPECT_EQ(pair.height, 480);
}

TEST(CameraYaml, NamesFileAndKeyThatIsWrong) {
  const TemporaryFolder folder;
  const auto error = [&](const std::string& from, const std::string& to) {
    const std::string path = folder.write("camera.yaml", replaced(kLeft, from, to));
    std::string text = errorText([&] { readCameraYaml(path); });
    EXPECT_TRUE(mentions(text, {path}));
    return text;
  };
  EXPECT_TRUE(mentions(error("image_width: 640", "image_width: wide"), {"image_width is not"}));
  EXPECT_TRUE(mentions(error("projection_matrix", "projection"), {"projection_matrix is not"}));
  EXPECT_TRUE(mentions(error(" 1., 0.]\n", " 1.]\n"), {"projection_matrix does not have 12"}));
  EXPECT_TRUE(mentions(error("520.5", "left"), {"camera_matrix is not"}));
  EXPECT_TRUE(mentions(error("image_width: 640", "]"), {"not valid YAML"}));
  EXPECT_TRUE(mentions(errorText([&] { readCameraYaml(folder.write("text", "words")); }),
                       {"not a calibrat"}));
  EXPECT_TRUE(mentions(errorText([&] { readCameraYaml(folder.file("none")); }), {"no such file"}));
  const std::string large = folder.write("large", kLeft);
  std::filesystem::resize_file(large, (1 << 20) + 1);
  EXPECT_TRUE(mentions(errorText([&] { readCameraYaml(large); }), {"at most 1048576"}));
}

TEST(CameraYaml, PairsThatAreNoneAreRejected) {
  const TemporaryFolder folder;
  const std::string left = folder.write("left.yaml", kLeft);
  const auto error = [&](const std::string& from, const std::string& to) {
    const std::string right = folder.write("right.yaml", replaced(kRight, from, to));
    std::string text = errorText([&] { readCameraYamlPair(left, right); });
    EXPECT_TRUE(mentions(text, {right}));
    return text;
  };
  EXPECT_TRUE(mentions(error("-60.", "60."), {"swapped"}));
  EXPECT_TRUE(mentions(error("-60.", "0."), {"calibrated separately"}));
  EXPECT_TRUE(mentions(error("240.25", "250."), {"center row"}));
  EXPECT_TRUE(mentions(error("500., 240.25", "600., 240.25"), {"focal length"}));
  EXPECT_TRUE(mentions(error("image_height: 480", "image_height: 479"), {"image height"}));
}

}  // namespace
}  // namespace cbmv
