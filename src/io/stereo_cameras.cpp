#include "io/stereo_cameras.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <regex>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "input/rig_rectification.h"
#include "io/binary_file.h"
#include "io/camera_yaml.h"
#include "io/key_value_file.h"
#include "io/yaml_file.h"

#include "cbmv_stereo/error.h"

namespace cbmv {
namespace {

constexpr std::uintmax_t kLargestFile = 1 << 20;
constexpr std::array<double, 9> kIdentity = {1, 0, 0, 0, 1, 0, 0, 0, 1};
constexpr const char* kPinholeModel = "plumb_bob";

enum class Format { kMiddlebury, kKittiRaw, kKittiPair, kEuroc, kRos };

/// A path and the selected KITTI cameras.
struct KittiPath {
  std::string file;
  std::string left = "00";
  std::string right = "01";
};

/// Parses "FILE:02,03", unless a file with exactly this name exists.
KittiPath parsePath(const std::string& path) {
  static const std::regex kWithCameras("(.+):0?([0-3]),0?([0-3])");
  std::smatch found;
  std::error_code ignored;
  if (std::filesystem::exists(path, ignored) || !std::regex_match(path, found, kWithCameras)) {
    return {path};
  }
  return {found[1], "0" + found[2].str(), "0" + found[3].str()};
}

/// The first line that begins with a key of a format decides.
Format findFormat(const std::string& path) {
  struct Mark {
    const char* begin;
    Format format;
  };
  constexpr std::array<Mark, 8> marks = {{{"cam0", Format::kMiddlebury},
                                          {"P_rect_0", Format::kKittiRaw},
                                          {"P0:", Format::kKittiPair},
                                          {"T_BS:", Format::kEuroc},
                                          {"image_width:", Format::kRos},
                                          {"camera_matrix:", Format::kRos},
                                          {"rectification_matrix:", Format::kRos},
                                          {"projection_matrix:", Format::kRos}}};
  std::ifstream in = openText(path, kLargestFile);
  for (std::string line; std::getline(in, line);) {
    line.erase(0, line.find_first_not_of(" \t"));
    for (const Mark& mark : marks) {
      if (line.rfind(mark.begin, 0) == 0) {
        return mark.format;
      }
    }
  }
  throw Error(
      "Cannot read " + path + ": it is not a camera calibration in a known format. Expected " +
      "Middlebury's calib.txt (with cam0, cam1), KITTI's calib_cam_to_cam.txt or P0 … P3, " +
      "a camera's YAML of ROS (with projection_matrix), or EuRoC's sensor.yaml (with T_BS).");
}

/// K is the left part of P, R is the identity, and there is no distortion. Nothing more is known
/// about a camera whose images were rectified by others.
CameraCalibration rectifiedCamera(const cv::Matx34d& projection) {
  CameraCalibration camera;
  const cv::Matx33d matrix = projection.get_minor<3, 3>(0, 0);
  std::copy_n(matrix.val, 9, camera.camera_matrix.begin());
  std::copy_n(projection.val, 12, camera.projection.begin());
  camera.rectification = kIdentity;
  camera.distortion_model = kPinholeModel;
  return camera;
}

StereoCameraFile readMiddlebury(const KittiPath& path) {
  const KeyValueFile file(path.file, '=');
  const auto read_camera = [&](const char* key, double baseline_m) {
    const cv::Matx33d matrix = file.cameraMatrix(key);
    cv::Matx34d projection;
    cv::hconcat(matrix, cv::Vec3d(-matrix(0, 0) * baseline_m, 0, 0), projection);
    CameraCalibration camera = rectifiedCamera(projection);
    camera.width = file.positiveInteger("width");
    camera.height = file.positiveInteger("height");
    return camera;
  };
  StereoCameraFile read;
  read.cameras.left = read_camera("cam0", 0.0);
  read.cameras.right = read_camera("cam1", file.positive("baseline") / 1000.0);
  read.disparities = file.has("ndisp") ? file.positiveInteger("ndisp") : 0;
  read.rectified = true;
  read.description = "calib.txt of Middlebury or ETH3D";
  return read;
}

template <std::size_t count>
std::array<double, count> kittiNumbers(const KeyValueFile& file, const std::string& key) {
  const std::vector<double> numbers = file.numbers(key);
  if (numbers.size() != count) {
    file.fail(key, "does not have " + std::to_string(count) + " numbers");
  }
  std::array<double, count> array{};
  std::copy(numbers.begin(), numbers.end(), array.begin());
  return array;
}

CameraCalibration readKittiRawCamera(const KeyValueFile& file, const std::string& number) {
  CameraCalibration camera;
  const std::array<double, 2> size = kittiNumbers<2>(file, "S_rect_" + number);
  camera.width = cv::saturate_cast<int>(size[0]);
  camera.height = cv::saturate_cast<int>(size[1]);
  camera.camera_matrix = kittiNumbers<9>(file, "K_" + number);
  camera.distortion_model = kPinholeModel;
  camera.distortion = file.numbers("D_" + number);
  camera.rectification = kittiNumbers<9>(file, "R_rect_" + number);
  camera.projection = kittiNumbers<12>(file, "P_rect_" + number);
  camera.name = "image_" + number;
  return camera;
}

/// Reads one of P0 … P3.
CameraCalibration readKittiProjection(const KeyValueFile& file, const std::string& number) {
  const auto projection = kittiNumbers<12>(file, "P" + number.substr(1));
  CameraCalibration camera = rectifiedCamera(cv::Matx34d(projection.data()));
  camera.name = "image_" + number;
  return camera;
}

StereoCameraFile readKitti(const KittiPath& path, Format format) {
  const KeyValueFile file(path.file, ':');
  const auto read_camera = format == Format::kKittiRaw ? readKittiRawCamera : readKittiProjection;
  StereoCameraFile read;
  read.cameras.left = read_camera(file, path.left);
  read.cameras.right = read_camera(file, path.right);
  read.rectified = true;
  read.description = "KITTI, cameras " + path.left + " and " + path.right;
  return read;
}

/// A camera of EuRoC and its pose: x_body = rotation · x_camera + translation.
struct EurocCamera {
  CameraCalibration camera;
  cv::Matx33d rotation;
  cv::Vec3d translation;
};

/// Converts EuRoC's names of models to those of ROS. Unknown names are kept and rejected later.
std::string rosDistortionModel(const std::string& model) {
  return model == "radial-tangential" || model == "radtan" ? kPinholeModel : model;
}

EurocCamera readEurocCamera(const std::string& path) {
  const YamlFile file(path, "sensor.yaml of EuRoC, which has keys such as T_BS and intrinsics");
  const std::string projection = file.text("camera_model");
  if (!projection.empty() && projection != "pinhole") {
    file.fail("camera_model", "is " + projection + ", expected pinhole");
  }
  EurocCamera read;
  const auto intrinsics = file.numbers<4>("intrinsics");  // fu, fv, cu, cv
  const auto resolution = file.numbers<2>("resolution");
  read.camera.width = cv::saturate_cast<int>(resolution[0]);
  read.camera.height = cv::saturate_cast<int>(resolution[1]);
  read.camera.camera_matrix = {
      intrinsics[0], 0, intrinsics[2], 0, intrinsics[1], intrinsics[3], 0, 0, 1};
  read.camera.distortion_model = rosDistortionModel(file.text("distortion_model"));
  read.camera.distortion = file.numbers("distortion_coefficients");
  if (read.camera.distortion_model == kPinholeModel && read.camera.distortion.size() == 4) {
    read.camera.distortion.push_back(0.0);  // k3: plumb_bob has five coefficients
  }
  const cv::Matx44d pose(file.numbers<16>("T_BS").data());
  read.rotation = pose.get_minor<3, 3>(0, 0);
  read.translation = {pose(0, 3), pose(1, 3), pose(2, 3)};
  return read;
}

StereoCameraFile readEuroc(const std::string& left_path, const std::string& right_path) {
  const EurocCamera left = readEurocCamera(left_path);
  const EurocCamera right = readEurocCamera(right_path);
  StereoCameraFile read;
  read.cameras = {left.camera, right.camera};
  RigTransform transform;
  transform.rotation = right.rotation.t() * left.rotation;
  transform.translation = right.rotation.t() * (left.translation - right.translation);
  try {
    rectifyRig(read.cameras, transform);
  } catch (const Error& error) {
    throw Error("Cannot use " + left_path + " and " + right_path + ": " + error.what());
  }
  read.description = "EuRoC's sensor.yaml of both cameras";
  return read;
}

StereoCameraFile readOneEach(const std::string& left_path, const std::string& right_path,
                             Format format) {
  if (right_path.empty()) {
    throw Error(left_path +
                " describes only the left camera, expected both cameras. Also give the file of the "
                "right camera.");
  }
  if (findFormat(right_path) != format) {
    throw Error(right_path + " has another format than " + left_path +
                ", expected the same format. Give two files of one calibration.");
  }
  if (format == Format::kEuroc) {
    return readEuroc(left_path, right_path);
  }
  StereoCameraFile read;
  read.cameras = {readCameraYaml(left_path), readCameraYaml(right_path)};
  read.description = "YAML files of ROS of both cameras";
  return read;
}

}  // namespace

StereoCameraFile readStereoCameras(const std::string& left_path, const std::string& right_path) {
  const KittiPath path = parsePath(left_path);
  const Format format = findFormat(path.file);
  if (format == Format::kEuroc || format == Format::kRos) {
    return readOneEach(left_path, right_path, format);
  }
  if (!right_path.empty()) {
    throw Error(left_path + " already describes both cameras, so " + right_path +
                " is not needed. Leave out the file of the right camera.");
  }
  return format == Format::kMiddlebury ? readMiddlebury(path) : readKitti(path, format);
}

}  // namespace cbmv
