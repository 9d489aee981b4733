#pragma once

#include <stdexcept>
#include <string>

#include "cbmv_stereo/export.h"

namespace cbmv {

/// Bad input from outside: a file, a message, a parameter. The text is one sentence that names the
/// thing, says what is wrong with it and what would be right. Tools print it and exit with status
/// 2, the node warns and drops the frame.
class CBMV_API Error : public std::runtime_error {
 public:
  explicit Error(const std::string& sentence) : std::runtime_error(sentence) {}
};

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
class CBMV_API InputError : public Error {
 public:
  InputError(InputFault fault, const std::string& text) : Error(text), fault_(fault) {}
  InputFault fault() const { return fault_; }

 private:
  InputFault fault_;
};

}  // namespace cbmv
