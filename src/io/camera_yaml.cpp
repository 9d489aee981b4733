#include "io/camera_yaml.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <locale>
#include <sstream>

#include <yaml-cpp/yaml.h>

#include "io/binary_file.h"
#include "io/yaml_file.h"

#include "cbmv_stereo/error.h"

namespace cbmv {
namespace {

constexpr double kSame = 1e-3;  // px: tolerance for rounded values

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
    throw Error("Cannot use " + path + ": its " + what +
                " differs from the left camera's, expected equal values. Use both files of one "
                "stereo calibration.");
  }
}

/// Requires fx = fy > 0, as in a rectified pair.
void requireRectified(const CameraCalibration& camera, const std::string& path) {
  const double fx = camera.projection[0];
  if (!(fx > 0) || std::abs(fx - camera.projection[5]) > kSame) {
    throw Error("Cannot use " + path +
                ": its projection_matrix has no single focal length above 0, expected equal fx and "
                "fy of a rectified stereo camera. Use the result of a stereo calibration.");
  }
}

}  // namespace

CameraCalibration readCameraYaml(const std::string& path) {
  const YamlFile file(path,
                      "calibration of a camera, which has keys such as image_width and "
                      "projection_matrix");
  CameraCalibration camera;
  camera.width = file.wholeNumber("image_width");
  camera.height = file.wholeNumber("image_height");
  camera.name = file.text("camera_name");
  camera.camera_matrix = file.numbers<9>("camera_matrix");
  camera.distortion_model = file.text("distortion_model");
  camera.distortion = file.numbers("distortion_coefficients");
  camera.rectification = file.numbers<9>("rectification_matrix");
  camera.projection = file.numbers<12>("projection_matrix");
  camera.binning_x = file.has("binning_x") ? std::max(1, file.wholeNumber("binning_x")) : 1;
  camera.binning_y = file.has("binning_y") ? std::max(1, file.wholeNumber("binning_y")) : 1;
  camera.roi = {file.wholeNumberIn("roi", "x_offset"), file.wholeNumberIn("roi", "y_offset"),
                file.wholeNumberIn("roi", "width"), file.wholeNumberIn("roi", "height")};
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
  requireSame(left.projection[0], right.projection[0], "focal length in projection_matrix",
              right_path);
  requireSame(left.projection[6], right.projection[6], "center row in projection_matrix",
              right_path);
  requireSame(left.width, right.width, "image width", right_path);
  requireSame(left.height, right.height, "image height", right_path);
  if (!(right.projection[3] < left.projection[3])) {
    throw Error("Cannot use " + right_path +
                ": the fourth value of its projection_matrix is not negative, expected -f times "
                "the baseline. The cameras are swapped or were calibrated separately: exchange the "
                "files, or use a stereo calibration.");
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
