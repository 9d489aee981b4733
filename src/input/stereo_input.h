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

/// A rectified pair as cameras and files give it.
struct StereoInput {
  cv::Mat left;                          ///< see toGrayPair
  cv::Mat right;                         ///< see toGrayPair
  std::optional<StereoCameras> cameras;  ///< none: disparities only, no depth
  RectifiedBy rectified_by = RectifiedBy::kOthers;
  InputNames names;
  std::vector<std::string> warnings;  ///< of whoever made it
};

/// The images in gray with 8 bits. Throws InputError if one is empty or the sizes differ.
GrayPair toGrayPair(const StereoInput& input);

}  // namespace cbmv
