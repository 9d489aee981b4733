#pragma once

#include <memory>
#include <string>
#include <vector>

#include <opencv2/core/types.hpp>

#include "offline/conversion.h"

namespace cbmv {

/// What a look at a recording finds before it is processed.
struct BagCheck {
  std::string text;                   ///< lines for people
  std::vector<std::string> problems;  ///< one sentence each; empty: it can be processed
  std::size_t frames = 0;             ///< to process
  cv::Size image_size;                ///< empty if the pair in the middle cannot be used
  double matching_s = 0;              ///< of matching a frame
  double processor_s = 0;             ///< the same, of all threads
};

/// The numbers and problems as a JSON object.
std::string checkJson(const BagCheck& check);

/// Looks at inputs, topics, plan and matching of `options`: what is in the bags, whether the pairs
/// synchronise, whether the calibration makes sense, and how long processing would take, by the
/// time that the pair in the middle takes. Throws Error
/// if there is no stereo camera in the bags.
BagCheck checkBags(const ConversionOptions& options, const std::shared_ptr<const Forest>& forest);

}  // namespace cbmv
