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

/// Calibrates by the pairs of a folder and prints how well that went; writes left.yaml and
/// right.yaml as camera_calibration_parsers reads them, and raw.bag with the pairs as a driver
/// publishes them in /stereo. Throws Error if there are no pairs, or too few of them show the
/// board.
void calibrate(const CalibrateArguments& arguments);

struct ShowRawArguments {
  std::string bag, output;
  std::size_t frames = 3;
};

/// Writes a picture of a recording: left images as rectified, each beside its disparities. Prints
/// how far apart the node found the rows. Throws Error if there is no frame.
void showRaw(const ShowRawArguments& arguments);

}  // namespace cbmv
