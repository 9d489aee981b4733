#pragma once

#include <stdexcept>
#include <string>

#include "cbmv_stereo/export.h"

namespace cbmv {

/// Invalid input: a file, a message or a parameter. The text says what is wrong (with the file,
/// topic or value), what was expected, and what to do. Tools print it and exit with status 2. The
/// node logs a warning and drops the frame.
class CBMV_API Error : public std::runtime_error {
 public:
  explicit Error(const std::string& message) : std::runtime_error(message) {}
};

/// Names of the inputs for error messages: topics of the node or files of a tool.
struct InputNames {
  std::string left_image;
  std::string left_info;  ///< calibration of the left camera
  std::string right_image;
  std::string right_info;  ///< calibration of the right camera
};

/// The kind of fault of an image pair or its calibration.
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

/// Images or calibrations that cannot be used. The text names the topic or file.
class CBMV_API InputError : public Error {
 public:
  InputError(InputFault fault, const std::string& text) : Error(text), fault_(fault) {}
  InputFault fault() const { return fault_; }

 private:
  InputFault fault_;
};

}  // namespace cbmv
