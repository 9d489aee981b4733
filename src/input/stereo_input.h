#pragma once

#include <optional>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "cbmv_stereo/calibration_check.h"
#include "cbmv_stereo/camera_calibration.h"
#include "cbmv_stereo/error.h"
#include "cbmv_stereo/gray_pair.h"

namespace cbmv {

/// A rectified pair from cameras or files.
struct StereoInput {
  cv::Mat left;                          ///< see toGrayPair
  cv::Mat right;                         ///< see toGrayPair
  std::optional<StereoCameras> cameras;  ///< none: only disparities, no depth
  RectifiedBy rectified_by = RectifiedBy::kOthers;
  InputNames names;
  std::vector<std::string> warnings;  ///< from the source of the pair
};

/// Converts the images to 8-bit gray. Throws InputError if an image is empty or the sizes differ.
GrayPair toGrayPair(const StereoInput& input);

}  // namespace cbmv
