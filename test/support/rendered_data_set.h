#pragma once

#include <filesystem>
#include <string>

#include "evaluation/rendered_scene.h"
#include "io/calibration.h"
#include "io/image_file.h"
#include "io/pfm.h"

namespace cbmv {

/// Writes the rendered pair to `folder` as a Middlebury v3 scene with 30 disparities.
inline void writeScene(const std::string& folder, const RenderedScene& scene) {
  std::filesystem::create_directories(folder);
  writeImage(folder + "/im0.png", scene.left);
  writeImage(folder + "/im1.png", scene.right);
  writePfm(folder + "/disp0GT.pfm", scene.truth);
  writeImage(folder + "/mask0nocc.png", scene.visible);
  StereoCalibration calibration;
  calibration.focal_length_px = 200;
  calibration.baseline_m = 0.1;
  calibration.width = scene.left.cols;
  calibration.height = scene.left.rows;
  calibration.disparities = 30;
  writeMiddleburyCalibration(folder + "/calib.txt", calibration);
}

}  // namespace cbmv
