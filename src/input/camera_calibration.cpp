#include "cbmv_stereo/camera_calibration.h"

#include <tuple>

namespace cbmv {

bool CameraCalibration::operator==(const CameraCalibration& other) const {
  const auto fields = [](const CameraCalibration& c) {
    return std::tie(c.name, c.width, c.height, c.camera_matrix, c.distortion_model, c.distortion,
                    c.rectification, c.projection, c.binning_x, c.binning_y);
  };
  return fields(*this) == fields(other) && roi == other.roi;
}

}  // namespace cbmv
