#pragma once

#include <string>

#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/Image.h>

#include "cbmv_stereo/error.h"

namespace cbmv {

/// One synchronised set of input messages, each with the topic it came on.
struct StereoMessages {
  sensor_msgs::ImageConstPtr left_image;
  sensor_msgs::CameraInfoConstPtr left_info;
  sensor_msgs::ImageConstPtr right_image;
  sensor_msgs::CameraInfoConstPtr right_info;
};

/// Resolved topic names of the inputs, for messages to people.
struct StereoTopics {
  std::string left_image;
  std::string left_info;
  std::string right_image;
  std::string right_info;
};

/// What is wrong with a set of input messages.
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

/// Input messages that cannot be used; the sentence names the topic.
class InputError : public Error {
 public:
  InputError(InputFault fault, const std::string& sentence) : Error(sentence), fault_(fault) {}
  InputFault fault() const { return fault_; }

 private:
  InputFault fault_;
};

}  // namespace cbmv
