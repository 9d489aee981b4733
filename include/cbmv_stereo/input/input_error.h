#pragma once

#include <string>

#include "cbmv_stereo/error.h"

namespace cbmv {

/// Names of the inputs for messages to people: topics of the node, files of a tool.
struct InputNames {
  std::string left_image;
  std::string left_info;  ///< of the left camera's calibration
  std::string right_image;
  std::string right_info;  ///< of the right camera's calibration
};

/// What is wrong with a pair of images or its calibration.
enum class InputFault {
  kEmptyImage,
  kUnsupportedEncoding,
  kTruncatedImage,
  kDifferentFrameIds,
  kDifferentSizes,
  kUncalibrated,
  kCameraInfoSize,
  kDisparityRange,
  kMemory,
};

/// Input that cannot be used; the text names the topic or file.
class InputError : public Error {
 public:
  InputError(InputFault fault, const std::string& text) : Error(text), fault_(fault) {}
  InputFault fault() const { return fault_; }

 private:
  InputFault fault_;
};

}  // namespace cbmv
