#pragma once

#include <memory>
#include <string>
#include <vector>

#include <opencv2/core/types.hpp>

#include "offline/bag_processing.h"

namespace cbmv {

/// Result of checking a bag before it is processed.
struct BagCheck {
  std::string text;                   ///< lines for the user
  std::vector<std::string> problems;  ///< one message each; empty: the bag can be processed
  std::size_t frames = 0;             ///< frames to process
  cv::Size image_size;                ///< empty if the middle pair cannot be used
  double matching_s = 0;              ///< wall time to match a frame, s
  double cpu_s = 0;                   ///< CPU time to match a frame, all threads, s
};

/// The numbers and problems as a JSON object.
std::string checkJson(const BagCheck& check);

/// Checks inputs, topics, plan and matching of `options`: the content of the bags, whether the
/// pairs synchronize, whether the calibration is plausible, and the expected processing time,
/// measured on the middle pair. Throws Error if the bags have no stereo camera.
BagCheck checkBags(const BagProcessingOptions& options,
                   const std::shared_ptr<const Forest>& forest);

}  // namespace cbmv
