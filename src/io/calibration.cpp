#include "io/calibration.h"

#include <algorithm>
#include <iomanip>
#include <locale>
#include <sstream>

#include "io/binary_file.h"
#include "io/key_value_file.h"

namespace cbmv {
StereoCalibration readMiddleburyCalibration(const std::string& path, int default_disparities) {
  const KeyValueFile file(path, '=');
  const cv::Matx33d left = file.cameraMatrix("cam0");
  const cv::Matx33d right = file.cameraMatrix("cam1");
  StereoCalibration calibration;
  calibration.focal_length_px = left(0, 0);
  calibration.cx_left = left(0, 2);
  calibration.cx_right = right(0, 2);
  calibration.cy = left(1, 2);
  calibration.baseline_m = file.positive("baseline") / 1000.0;
  calibration.width = file.positiveInteger("width");
  calibration.height = file.positiveInteger("height");
  calibration.disparities = default_disparities > 0 && !file.has("ndisp")
                                ? std::min(default_disparities, calibration.width)
                                : file.positiveInteger("ndisp");
  return calibration;
}

void writeMiddleburyCalibration(const std::string& path, const StereoCalibration& calibration) {
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text << std::setprecision(12);
  const auto write_matrix = [&](const char* key, double cx) {
    const double f = calibration.focal_length_px;
    text << key << "=[" << f << " 0 " << cx << "; 0 " << f << ' ' << calibration.cy << "; 0 0 1]\n";
  };
  write_matrix("cam0", calibration.cx_left);
  write_matrix("cam1", calibration.cx_right);
  text << "doffs=" << calibration.doffs() << "\nbaseline=" << calibration.baseline_m * 1000.0
       << "\nwidth=" << calibration.width << "\nheight=" << calibration.height
       << "\nndisp=" << calibration.disparities << '\n';
  writeFile(path, text.str());
}

}  // namespace cbmv
