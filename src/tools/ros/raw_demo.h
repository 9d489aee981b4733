#pragma once

#include <cstddef>
#include <string>

#include "tools/rig_calibration.h"

namespace cbmv {

struct CalibrateArguments {
  std::string folder, output;
  Chessboard board;
  double rate_hz = 1.0;
};

/// Calibrates a rig from the image pairs of a folder and prints the errors. Writes left.yaml and
/// right.yaml for camera_calibration_parsers, and raw.bag with the pairs in namespace /stereo, as
/// published by a driver. Throws Error if there are no pairs or too few of them show the board.
void calibrate(const CalibrateArguments& arguments);

struct ShowRawArguments {
  std::string bag, output;
  std::size_t frames = 3;
};

/// Writes a picture of a bag: rectified left images beside their disparities. Prints the vertical
/// offset that the node measured. Throws Error if there is no frame.
void showRaw(const ShowRawArguments& arguments);

}  // namespace cbmv
