#include "cbmv_stereo/io/camera_yaml.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iomanip>
#include <locale>
#include <sstream>

#include <yaml-cpp/yaml.h>

#include "binary_file.h"

#include "cbmv_stereo/error.h"

namespace cbmv {
namespace {

constexpr std::uintmax_t kLargestFile = 1 << 20;
constexpr double kSame = 1e-3;  // px: what calibrations that were rounded may differ by

/// The keys of one file, and what to say about those that are not as they should be.
class CameraFile {
 public:
  explicit CameraFile(const std::string& path) : path_(path) {
    std::ifstream in = openForReading(path, kLargestFile);
    try {
      root_ = YAML::Load(in);
    } catch (const YAML::Exception& error) {
      throw Error("Cannot read " + path + ": it is no YAML, " + error.what() + ".");
    }
    if (!root_.IsMap()) {
      throw Error("Cannot read " + path + ": it is no calibration of a camera, which has keys " +
                  "such as image_width and projection_matrix.");
    }
  }

  int wholeNumber(const char* key) const {
    try {
      return root_[key].as<int>();
    } catch (const YAML::Exception&) {
      throw Error("Cannot read " + path_ + ": key " + key + " must be a whole number.");
    }
  }

  /// Empty where there is none.
  std::string text(const char* key) const { return root_[key].as<std::string>(""); }

  template <std::size_t count>
  std::array<double, count> matrix(const char* key) const {
    const std::vector<double> numbers = data(key);
    if (numbers.size() != count) {
      failMatrix(key, count);
    }
    std::array<double, count> matrix{};
    std::copy(numbers.begin(), numbers.end(), matrix.begin());
    return matrix;
  }

  std::vector<double> data(const char* key) const {
    try {
      return root_[key]["data"].as<std::vector<double>>();
    } catch (const YAML::Exception&) {
      throw Error("Cannot read " + path_ + ": key " + key + " must hold a list of numbers, data.");
    }
  }

 private:
  [[noreturn]] void failMatrix(const char* key, std::size_t count) const {
    throw Error("Cannot read " + path_ + ": key " + key + " must hold " + std::to_string(count) +
                " numbers in data.");
  }

  std::string path_;
  YAML::Node root_;
};

template <typename Numbers>
void writeMatrix(std::ostream& text, const char* key, std::size_t rows, const Numbers& numbers) {
  text << key << ":\n  rows: " << rows << "\n  cols: " << numbers.size() / rows << "\n  data: [";
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    text << (i == 0 ? "" : ", ") << numbers[i];
  }
  text << "]\n";
}

void requireSame(double left, double right, const std::string& what, const std::string& path) {
  if (std::abs(left - right) > kSame) {
    throw Error("Cannot use " + path + ": its projection_matrix has another " + what +
                " than the left camera's; both must be of one stereo calibration.");
  }
}

/// A pixel of a rectified pair is as wide as high.
void requireRectified(const CameraCalibration& camera, const std::string& path) {
  const double fx = camera.projection[0];
  if (!(fx > 0) || std::abs(fx - camera.projection[5]) > kSame) {
    throw Error("Cannot use " + path + ": its projection_matrix must have one focal length above " +
                "0, as that of a rectified stereo camera.");
  }
}

}  // namespace

CameraCalibration readCameraYaml(const std::string& path) {
  const CameraFile file(path);
  CameraCalibration camera;
  camera.width = file.wholeNumber("image_width");
  camera.height = file.wholeNumber("image_height");
  camera.name = file.text("camera_name");
  camera.camera_matrix = file.matrix<9>("camera_matrix");
  camera.distortion_model = file.text("distortion_model");
  camera.distortion = file.data("distortion_coefficients");
  camera.rectification = file.matrix<9>("rectification_matrix");
  camera.projection = file.matrix<12>("projection_matrix");
  return camera;
}

void writeCameraYaml(const std::string& path, const CameraCalibration& camera) {
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text << std::setprecision(17) << "image_width: " << camera.width
       << "\nimage_height: " << camera.height
       << "\ncamera_name: " << YAML::Dump(YAML::Node(camera.name)) << "\n";
  writeMatrix(text, "camera_matrix", 3, camera.camera_matrix);
  text << "distortion_model: " << camera.distortion_model << "\n";
  writeMatrix(text, "distortion_coefficients", 1, camera.distortion);
  writeMatrix(text, "rectification_matrix", 3, camera.rectification);
  writeMatrix(text, "projection_matrix", 3, camera.projection);
  writeFile(path, text.str());
}

StereoCalibration readCameraYamlPair(const std::string& left_path, const std::string& right_path) {
  const CameraCalibration left = readCameraYaml(left_path);
  const CameraCalibration right = readCameraYaml(right_path);
  requireRectified(left, left_path);
  requireRectified(right, right_path);
  requireSame(left.projection[0], right.projection[0], "focal length", right_path);
  requireSame(left.projection[6], right.projection[6], "centre row", right_path);
  requireSame(left.width, right.width, "image width", right_path);
  requireSame(left.height, right.height, "image height", right_path);
  if (!(right.projection[3] < left.projection[3])) {
    throw Error(
        "Cannot use " + right_path + ": its projection_matrix must have a negative fourth " +
        "number, -f times the baseline; the cameras are swapped, or calibrated one by one.");
  }
  StereoCalibration calibration;
  calibration.focal_length_px = left.projection[0];
  calibration.cx_left = left.projection[2];
  calibration.cx_right = right.projection[2];
  calibration.cy = left.projection[6];
  calibration.baseline_m = (left.projection[3] - right.projection[3]) / left.projection[0];
  calibration.width = left.width;
  calibration.height = left.height;
  return calibration;
}

}  // namespace cbmv
